// SPDX-License-Identifier: Apache-2.0
#include "service/live/keyboard_joystick.hpp"

#include <poll.h>
#include <unistd.h>

#include <array>

namespace surefoot::app {
namespace {

constexpr std::uint8_t kAhead = 9, kRight = 13, kBack = 17, kLeft = 21;  // outer ring: N E S W
constexpr std::uint8_t kTurnLeft = 25, kTurnRight = 26;

}  // namespace

void KeyReader::read(std::string_view bytes) {
    for (const char byte : bytes) {
        switch (escape_) {
            case Escape::none: key(byte); break;
            case Escape::begun: escape_ = byte == '[' ? Escape::bracket : Escape::none; break;
            case Escape::bracket:
                escape_ = Escape::none;
                arrow(byte);
                break;
        }
    }
}

void KeyReader::key(char byte) {
    constexpr char kEscape = '\x1b', kEndOfInput = '\x04';
    switch (byte) {
        case kEscape: escape_ = Escape::begun; break;
        case 'w': code_ = kAhead; break;
        case 'a': code_ = kLeft; break;
        case 's': code_ = kBack; break;
        case 'd': code_ = kRight; break;
        case 'q': code_ = kTurnLeft; break;
        case 'e': code_ = kTurnRight; break;
        case ' ': code_ = 0; break;
        case 'x':
        case kEndOfInput: finished_ = true; break;
        default: break;
    }
}

void KeyReader::arrow(char byte) {
    switch (byte) {
        case 'A': code_ = kAhead; break;
        case 'B': code_ = kBack; break;
        case 'C': code_ = kRight; break;
        case 'D': code_ = kLeft; break;
        default: break;
    }
}

KeyboardJoystick::KeyboardJoystick() {
    termios settings{};
    if (tcgetattr(STDIN_FILENO, &settings) != 0) return;
    before_ = settings;
    settings.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);  // Ctrl-C still sends SIGINT
    tcsetattr(STDIN_FILENO, TCSANOW, &settings);
}

KeyboardJoystick::~KeyboardJoystick() {
    if (before_) tcsetattr(STDIN_FILENO, TCSANOW, &*before_);
}

std::optional<std::uint8_t> KeyboardJoystick::poll() {
    pollfd input{STDIN_FILENO, POLLIN, 0};
    if (::poll(&input, 1, 0) > 0) {
        std::array<char, 64> bytes{};
        const ssize_t count = ::read(STDIN_FILENO, bytes.data(), bytes.size());
        if (count <= 0) return std::nullopt;
        keys_.read({bytes.data(), static_cast<std::size_t>(count)});
    }
    if (keys_.finished()) return std::nullopt;
    return keys_.code();
}

}  // namespace surefoot::app
