// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "surefoot/core/machine.hpp"
#include "surefoot/core/pose.hpp"
#include "surefoot/core/result.hpp"
#include "surefoot/io/settings/rated_limits.hpp"

namespace surefoot::io {

/// Range of one joint of the machine [deg].
struct JointRange {
    std::string name;
    double min_deg = 0.0;
    double max_deg = 0.0;
};

/// Contents of a machine file. machines/rex.yaml shows every key except `deviations`, which
/// docs/reference/machine_file.md explains.
struct MachineFile {
    std::string name;
    Machine machine;               ///< the part of the file that the gate needs
    Pose T_body_left;              ///< mount: pose of the left optical frame in base_link
    double mount_pitch_deg = 0.0;  ///< pitch of the mount [deg], downward positive
    double speed_m_s = 0.0;        ///< fastest motion of base_link [m/s]; 0 = unknown
    double turn_deg_s = 0.0;       ///< fastest turn of base_link [deg/s]; 0 = unknown
    std::vector<JointRange> joints;
    std::vector<Deviation> deviations;  ///< limits laxer than rated, each signed by a person
    std::vector<std::string> notes;     ///< a sentence for each key that has a former name
    std::uint64_t hash = 0;             ///< FNV-1a of the file's bytes, for logs
};

/// Strict: every key except `deviations` must be present, once and inside its range, and no other
/// key is allowed. Otherwise a usage error names file, line, key, value and limit. Lengths are
/// rounded to 0.1 mm. A limit that is laxer than its rated value (rated_limits.hpp) needs an entry
/// in `deviations`. A step of class walk that is higher than the swing clearance is refused even
/// with a signature.
[[nodiscard]] Result<MachineFile> parse_machine(std::string_view yaml, const std::string& file);
[[nodiscard]] Result<MachineFile> read_machine(const std::string& path);

}  // namespace surefoot::io
