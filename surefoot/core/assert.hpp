// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace surefoot::detail {

/// Prints the broken invariant to stderr and aborts. It is a bug in our code, not an input error.
[[noreturn]] void assertion_failed(const char* condition, const char* file, int line) noexcept;

}  // namespace surefoot::detail

/// Checks an invariant of the code. Active unless NDEBUG is set without SUREFOOT_ASSERTS.
#if !defined(NDEBUG) || defined(SUREFOOT_ASSERTS)
#define SUREFOOT_ASSERT(condition)                                                              \
    do {                                                                                        \
        if (!(condition)) ::surefoot::detail::assertion_failed(#condition, __FILE__, __LINE__); \
    } while (false)
#else
#define SUREFOOT_ASSERT(condition) static_cast<void>(sizeof((condition) ? 1 : 0))
#endif
