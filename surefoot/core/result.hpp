// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <variant>

#include "surefoot/core/assert.hpp"

namespace surefoot {

/// Class of a failure. It determines the exit code.
enum class ErrorCode {
    usage,        ///< wrong call or configuration: exit 2
    input,        ///< a file, recording or device cannot be used: exit 1
    output,       ///< results cannot be written: exit 1
    interrupted,  ///< the user stopped the run: exit 1
};

/// A failure with its message: what happened, where, value, limit and what to do.
struct Error {
    ErrorCode code = ErrorCode::input;
    std::string message;
};

/// A value, or the reason for its absence: a problem of files, devices, configuration or messages,
/// or a stop by the user. It is not for bugs (SUREFOOT_ASSERT reports them) and not for events in a
/// recording, for example blur or a gap: these are enum values in a report.
template <typename T>
class [[nodiscard]] Result {
  public:
    Result(T value) : content_(std::in_place_index<0>, std::move(value)) {}
    Result(Error error) : content_(std::in_place_index<1>, std::move(error)) {}

    [[nodiscard]] bool ok() const noexcept { return content_.index() == 0; }
    explicit operator bool() const noexcept { return ok(); }

    [[nodiscard]] T& value() & {
        SUREFOOT_ASSERT(ok());
        return *std::get_if<0>(&content_);
    }
    [[nodiscard]] const T& value() const& {
        SUREFOOT_ASSERT(ok());
        return *std::get_if<0>(&content_);
    }
    [[nodiscard]] T&& value() && {
        SUREFOOT_ASSERT(ok());
        return std::move(*std::get_if<0>(&content_));
    }
    [[nodiscard]] const Error& error() const {
        SUREFOOT_ASSERT(!ok());
        return *std::get_if<1>(&content_);
    }

    T& operator*() & { return value(); }
    const T& operator*() const& { return value(); }
    T* operator->() { return &value(); }
    const T* operator->() const { return &value(); }

  private:
    std::variant<T, Error> content_;
};

/// Success without a value, or the reason of the failure.
template <>
class [[nodiscard]] Result<void> {
  public:
    Result() = default;
    Result(Error error) : error_(std::move(error)) {}

    [[nodiscard]] bool ok() const noexcept { return !error_.has_value(); }
    explicit operator bool() const noexcept { return ok(); }
    [[nodiscard]] const Error& error() const {
        SUREFOOT_ASSERT(!ok());
        return *error_;
    }

  private:
    std::optional<Error> error_;
};

using Status = Result<void>;

[[nodiscard]] inline Error input_error(std::string message) {
    return {ErrorCode::input, std::move(message)};
}
[[nodiscard]] inline Error usage_error(std::string message) {
    return {ErrorCode::usage, std::move(message)};
}
[[nodiscard]] inline Error output_error(std::string message) {
    return {ErrorCode::output, std::move(message)};
}

}  // namespace surefoot
