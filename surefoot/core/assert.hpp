// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace surefoot::detail {

/// Prints the broken invariant to stderr and aborts. The code has a bug; the input is not wrong.
[[noreturn]] void assertion_failed(const char* condition, const char* file, int line) noexcept;

}  // namespace surefoot::detail

/// Checks an invariant of the code. Inactive only if NDEBUG is set and SUREFOOT_ASSERTS is not.
#if !defined(NDEBUG) || defined(SUREFOOT_ASSERTS)
#define SUREFOOT_ASSERT(condition)                                                              \
    do {                                                                                        \
        if (!(condition)) ::surefoot::detail::assertion_failed(#condition, __FILE__, __LINE__); \
    } while (false)
#else
#define SUREFOOT_ASSERT(condition) static_cast<void>(sizeof((condition) ? 1 : 0))
#endif
