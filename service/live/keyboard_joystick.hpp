// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <termios.h>

#include <cstdint>
#include <optional>
#include <string_view>

namespace surefoot::app {

/// Translates keys into joystick codes. A code stays until another key changes it.
class KeyReader {
  public:
    /// Reads bytes from the terminal. w, a, s, d or arrow keys: step ahead, left, back, right. q:
    /// turn left; e: turn right; space bar: rest; x: end. Other keys have no effect.
    void read(std::string_view bytes);
    [[nodiscard]] std::uint8_t code() const noexcept { return code_; }
    /// Returns true after the user pressed x or Ctrl-D.
    [[nodiscard]] bool finished() const noexcept { return finished_; }

  private:
    enum class Escape : std::uint8_t { none, begun, bracket };
    void key(char byte);
    void arrow(char byte);

    Escape escape_ = Escape::none;  ///< an arrow key sends ESC [ A to D, maybe byte by byte
    std::uint8_t code_ = 0;
    bool finished_ = false;
};

/// Reads joystick codes from the keys on stdin. While an object lives, the terminal delivers each
/// key at once and does not echo it; the destructor restores the terminal's settings.
class KeyboardJoystick {
  public:
    KeyboardJoystick();
    ~KeyboardJoystick();
    KeyboardJoystick(const KeyboardJoystick&) = delete;
    KeyboardJoystick& operator=(const KeyboardJoystick&) = delete;

    /// Returns the current code, or nullopt after x, Ctrl-D or the end of stdin. Does not wait.
    [[nodiscard]] std::optional<std::uint8_t> poll();

  private:
    KeyReader keys_;
    std::optional<termios> before_;  ///< original settings; nullopt = stdin is not a terminal
};

}  // namespace surefoot::app
