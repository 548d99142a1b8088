// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <type_traits>

namespace surefoot {

/// Visits the fields of a configuration. Every config struct lists its fields once, in
/// `describe(ConfigVisitor&)`: key, range and comment. The initialisers of the members are the
/// defaults. Readers, writers, `surefoot config` and the range checks are visitors.
class ConfigVisitor {
  public:
    virtual ~ConfigVisitor() = default;

    virtual void begin_group(const char* name) = 0;
    virtual void end_group() = 0;
    /// `key` ends in the unit of the value, if any. A value must be finite and within [min, max].
    virtual void number(
        const char* key, double& value, double min, double max, const char* comment) = 0;
    virtual void integer(const char* key, int& value, int min, int max, const char* comment) = 0;
    virtual void boolean(const char* key, bool& value, const char* comment) = 0;
    /// `value` is an index into `names`.
    virtual void choice(const char* key,
                        int& value,
                        std::span<const char* const> names,
                        const char* comment) = 0;

    /// Visits an enum whose enumerators count from 0 in the order of `names`.
    template <typename Enum>
    void enumeration(const char* key,
                     Enum& value,
                     std::span<const char* const> names,
                     const char* comment) {
        static_assert(std::is_enum_v<Enum>);
        int position = static_cast<int>(value);  // in range: an enumerator
        choice(key, position, names, comment);
        value = static_cast<Enum>(position);
    }
    /// Visits a nested config as a group with its own name.
    template <typename Config>
    void group(const char* name, Config& config) {
        begin_group(name);
        config.describe(*this);
        end_group();
    }
};

}  // namespace surefoot
