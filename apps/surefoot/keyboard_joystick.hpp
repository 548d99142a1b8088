// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <termios.h>

#include <cstdint>
#include <optional>
#include <string_view>

namespace surefoot::app {

/// Reads keys as a joystick that stays where it was pushed.
class KeyReader {
  public:
    /// w/a/s/d or arrows: a step ahead, to the left, back, to the right; q and e turn left and
    /// right; the space bar is rest. Other keys change nothing.
    void read(std::string_view bytes);
    [[nodiscard]] std::uint8_t code() const noexcept { return code_; }
    /// x was pressed, or Ctrl-D.
    [[nodiscard]] bool finished() const noexcept { return finished_; }

  private:
    enum class Escape : std::uint8_t { none, begun, bracket };
    void key(char byte);
    void arrow(char byte);

    Escape escape_ = Escape::none;  ///< arrows are ESC [ A ... D, and may come in pieces
    std::uint8_t code_ = 0;
    bool finished_ = false;
};

/// Keys of stdin. A terminal gives each key at once and shows none while this lives.
class KeyboardJoystick {
  public:
    KeyboardJoystick();
    ~KeyboardJoystick();
    KeyboardJoystick(const KeyboardJoystick&) = delete;
    KeyboardJoystick& operator=(const KeyboardJoystick&) = delete;

    /// The code now, or nothing once the user has finished or stdin ended. Does not wait.
    [[nodiscard]] std::optional<std::uint8_t> poll();

  private:
    KeyReader keys_;
    std::optional<termios> before_;  ///< the terminal's settings; nothing = stdin is none
};

}  // namespace surefoot::app
