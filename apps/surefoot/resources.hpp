// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "surefoot/core/result.hpp"
#include "surefoot/io/settings/machine_file.hpp"

namespace surefoot::app {

/// A file of the repository that travels inside the program.
struct Resource {
    std::string_view name;  ///< "machines/rex.yaml"
    std::string_view text;
};
[[nodiscard]] const std::vector<Resource>& resources();

/// Text of `folder/name.yaml`; an unknown name is a usage error that lists the known ones.
[[nodiscard]] Result<std::string> find_resource(std::string_view folder, std::string_view name);

/// The same among other files than these.
[[nodiscard]] Result<std::string> find_resource(const std::vector<Resource>& among,
                                                std::string_view folder,
                                                std::string_view name);

/// A machine file by path or by built-in name; whatever is wrong with it is a usage error. The
/// gate's self-test (gate::Canaries) is part of reading one, so that `surefoot gate`,
/// `surefoot-gate` and every other program refuse the same machines. Takes about 10 ms.
[[nodiscard]] Result<io::MachineFile> find_machine(const std::string& path_or_name);

}  // namespace surefoot::app
