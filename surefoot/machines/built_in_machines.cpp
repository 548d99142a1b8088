// SPDX-License-Identifier: Apache-2.0
#include "surefoot/machines/built_in_machines.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>
#include <memory>

#include "surefoot/core/nearest_names.hpp"
#include "surefoot/gate/canary.hpp"

namespace surefoot::machines {

Result<std::string> find_resource(const std::vector<Resource>& resources,
                                  std::string_view folder,
                                  std::string_view name) {
    const std::string wanted = fmt::format("{}/{}.yaml", folder, name);
    std::vector<std::string> known;
    for (const Resource& resource : resources) {
        if (resource.name == wanted) return std::string(resource.text);
        if (resource.name.starts_with(fmt::format("{}/", folder))) {
            known.emplace_back(
                resource.name.substr(folder.size() + 1, resource.name.size() - folder.size() - 6));
        }
    }
    const std::string likely = did_you_mean(name, known);
    return usage_error(
        fmt::format("there is no file '{0}', and no '{0}' among the built-in {1}{2} "
                    "Known names: {3}",
                    name,
                    folder,
                    likely.empty() ? "." : likely,
                    fmt::join(known, ", ")));
}

namespace {

/// Refuses a machine with which the gate fails its self-test: the gate would never be ready, or
/// would give wrong answers. All programs use this check.
Status self_test(const std::string& name, const Machine& machine) {
    const auto outcome = std::make_unique<gate::Canaries>(machine)->judge_all();
    if (outcome.passed) return {};
    return usage_error(
        fmt::format("{}: with this machine the gate fails its self-test, the question {} with "
                    "movement {}: expected {}, found {}; check feet, body, movements and "
                    "limits",
                    name,
                    outcome.name,
                    outcome.command,
                    gate::to_string(outcome.expected),
                    gate::to_string(outcome.found)));
}

}  // namespace

Result<io::MachineFile> load_machine(const std::string& path_or_name) {
    const auto read = [&]() -> Result<io::MachineFile> {
        if (std::filesystem::exists(path_or_name)) return io::read_machine(path_or_name);
        const auto text = find_resource(built_in_machines(), "machines", path_or_name);
        if (!text) return text.error();
        return io::parse_machine(*text, fmt::format("machine {}", path_or_name));
    };
    auto machine = read();
    if (!machine) return usage_error(machine.error().message);
    if (Status status = self_test(path_or_name, machine->machine); !status) return status.error();
    return machine;
}

}  // namespace surefoot::machines
