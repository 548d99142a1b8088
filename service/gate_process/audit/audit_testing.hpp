// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>

#include "service/gate_process/audit/audit_record.hpp"
#include "surefoot/core/rng.hpp"
#include "surefoot/core/unknown.hpp"
#include "surefoot/gate/gate_testing.hpp"

/// Random ground and queries for the tests of the audit log.
namespace surefoot::gate_process::testing {

using gate::testing::kNowNs;
using gate::testing::kReady;
using gate::testing::rex;
using gate::testing::seal;

/// A verdict with all its inputs.
struct Case {
    Machine machine = rex();
    gate::Query query;
    gate::GateHealth health = kReady;
    std::int64_t now_ns = kNowNs;
    std::unique_ptr<grid::MapSnapshot> map;
    gate::Verdict verdict;

    void decide() { verdict = gate::decide(machine, query, *map, health, now_ns); }
    [[nodiscard]] AuditedVerdict audited() const { return {query, health, now_ns, *map, verdict}; }
    [[nodiscard]] CellBox zone() const {
        return query_zone(machine, query, *map, verdict.evidence.max_drift_tenth_mm);
    }
};

/// A floor with noise, objects, holes, unknown cells and drop evidence.
inline std::unique_ptr<grid::MapSnapshot> random_ground(Rng& rng) {
    gate::testing::Terrain terrain;
    const double tilt_x = rng.uniform(-0.03, 0.03);
    for (int v = 0; v < terrain.geometry.ny; ++v) {
        for (int u = 0; u < terrain.geometry.nx; ++u)
            terrain.height.at(u, v) = static_cast<float>(
                tilt_x * terrain.geometry.center_m({u, v}).x() + 0.002 * rng.normal());
    }
    const auto place = [&](grid::Layer& layer, double value) {
        const double x = rng.uniform(-2.0, 1.6);
        const double y = rng.uniform(-2.0, 1.6);
        terrain.paint(layer, x, x + rng.uniform(0.03, 0.9), y, y + rng.uniform(0.03, 0.9), value);
    };
    for (auto things = rng.below(8); things > 0; --things) {
        const double kind = rng.uniform();
        if (kind < 0.3) {
            place(terrain.height, rng.uniform(0.03, 0.8));
        } else if (kind < 0.5) {
            place(terrain.height, rng.uniform(-0.5, -0.03));
        } else if (kind < 0.7) {
            place(terrain.height, static_cast<double>(kNanF));
        } else if (kind < 0.8) {
            place(terrain.clearance, rng.uniform(0.3, 2.5));
        } else if (kind < 0.9) {
            place(terrain.variance, rng.uniform(1e-5, 1e-3));
        } else {
            place(terrain.drift, rng.uniform(0.005, 0.05));
        }
    }
    return terrain.snapshot();
}

/// A query anywhere on that ground or at its border, with or without an attested area.
inline gate::Query random_query(Rng& rng) {
    const double yaw_rad = rng.uniform(-4.0, 4.0);
    const double reach_m = rng.below(4) == 0 ? 3.4 : 1.5;
    gate::Query query = gate::make_query(static_cast<std::uint8_t>(1 + rng.below(26)),
                                         rng.uniform(-reach_m, reach_m),
                                         rng.uniform(-reach_m, reach_m),
                                         std::cos(yaw_rad),
                                         std::sin(yaw_rad));
    query.connection = rng.next_u64();
    query.sequence = rng.next_u64();
    if (rng.below(2) == 0) {
        const auto off = [&rng] { return static_cast<std::int64_t>(rng.uniform(-2500.0, 2500.0)); };
        query.attested = {true,
                          query.x_tenth_mm + off(),
                          query.y_tenth_mm + off(),
                          static_cast<std::int32_t>(2000 + rng.below(8000)),
                          static_cast<std::int32_t>(rng.uniform(-300.0, 300.0))};
    }
    if (rng.below(4) == 0) {
        query.stance_source = gate::StanceHeight::given;
        query.stance_height_tenth_mm = static_cast<std::int32_t>(rng.uniform(-200.0, 200.0));
    }
    return query;
}

/// Makes the cells around base_link unknown, like ground that the camera cannot see.
inline void blind(grid::MapSnapshot& map, const gate::Query& query, std::int64_t radius_tenth_mm) {
    for (std::int32_t iy = 0; iy < map.ny; ++iy) {
        for (std::int32_t ix = 0; ix < map.nx; ++ix) {
            const std::int64_t side = map.resolution_tenth_mm;
            const std::int64_t dx = map.origin_x_tenth_mm + ix * side - query.x_tenth_mm;
            const std::int64_t dy = map.origin_y_tenth_mm + iy * side - query.y_tenth_mm;
            if (dx * dx + dy * dy <= radius_tenth_mm * radius_tenth_mm)
                map.source[static_cast<std::size_t>(iy * map.nx + ix)] =
                    grid::EvidenceSource::unknown;
        }
    }
    seal(map);
}

/// The REX with random feet, bands, margins and bodies, so that different regions reach farthest.
inline Machine random_machine(Rng& rng) {
    const auto between = [&rng](int low, int high) {
        return low + static_cast<std::int32_t>(rng.below(static_cast<std::uint64_t>(high - low)));
    };
    Machine machine = rex();
    machine.left_foot.center_x_tenth_mm = between(-3000, 3000);
    machine.right_foot.center_y_tenth_mm = between(-4000, 0);
    machine.limits.drop_band_tenth_mm = between(500, 3000);
    machine.limits.foot_margin_tenth_mm = between(0, 2000);
    machine.body.count = between(1, 4);
    for (BodyPart& part : machine.body.parts)
        part = {
            {between(-3000, 3000), between(-3000, 3000), between(500, 6000), between(500, 6000)},
            between(500, 3000),
            between(4000, 20'000)};
    machine.body.sway_tenth_mm = between(0, 1500);
    return machine;
}

inline Case random_case(Rng& rng, const Machine& machine = rex()) {
    Case c;
    c.machine = machine;
    c.map = random_ground(rng);
    c.query = random_query(rng);
    if (c.query.attested.active) blind(*c.map, c.query, static_cast<std::int64_t>(rng.below(5000)));
    c.decide();
    return c;
}

/// The log record of a case.
inline std::string record_of(const Case& c) {
    const CellBox zone = c.zone();
    std::string bytes(record_bytes(c.audited(), zone), '\0');
    write_record(hash_of(c.machine), c.audited(), zone, bytes.data());
    return bytes;
}

/// The same record in format version 2: without the uncertainty of the vertical, with the snapshot
/// layout of version 2.
inline std::string record_of_version_2(const Case& c) {
    constexpr std::uint32_t kLayoutOfVersion2 = 4;
    const auto copy = std::make_unique<grid::MapSnapshot>(*c.map);
    grid::MapSnapshot& map = *copy;
    map.layout = kLayoutOfVersion2;
    const CellBox zone = c.zone();
    const auto written = [&](std::uint32_t tilt_sigma_urad) {
        map.tilt_sigma_urad = tilt_sigma_urad;
        const AuditedVerdict audited{c.query, c.health, c.now_ns, map, c.verdict};
        std::string bytes(record_bytes(audited, zone), '\0');
        write_record(hash_of(c.machine), audited, zone, bytes.data());
        return bytes;
    };
    // The field is at the position where records with two values differ.
    const std::string bytes = written(0);
    const std::string other = written(0xffffffff);
    const auto at = std::mismatch(bytes.begin(), bytes.end(), other.begin()).first - bytes.begin();
    return bytes.substr(0, static_cast<std::size_t>(at)) +
           bytes.substr(static_cast<std::size_t>(at) + sizeof(map.tilt_sigma_urad));
}

/// All differences in one line, for failure messages.
inline std::string words(const std::vector<FieldDifference>& differences) {
    std::string text;
    for (const FieldDifference& d : differences)
        text += d.field + " " + d.recorded + " / " + d.replayed + "; ";
    return text;
}

}  // namespace surefoot::gate_process::testing
