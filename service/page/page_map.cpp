// SPDX-License-Identifier: Apache-2.0
#include "service/page/page_map.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

#include "service/page/little_endian.hpp"
#include "service/page/page_messages.hpp"

namespace surefoot::page {
namespace {

constexpr std::int64_t kTenthsPerMm = 10;
constexpr std::int64_t kBaseStep_tenth_mm = 100'000;  ///< a base height is a multiple of 10 m
constexpr std::int64_t kBaseReach_tenth_mm = 200'000;

std::size_t element(int ix, int iy, int nx) noexcept {
    return static_cast<std::size_t>(iy) * static_cast<std::size_t>(nx) +
           static_cast<std::size_t>(ix);
}

std::int32_t base_near(std::int64_t body_z_tenth_mm, std::int32_t before_tenth_mm) noexcept {
    const std::int64_t away = body_z_tenth_mm - before_tenth_mm;
    if (away >= -kBaseReach_tenth_mm && away <= kBaseReach_tenth_mm) return before_tenth_mm;
    constexpr std::int64_t kFarthest = std::numeric_limits<std::int32_t>::max();
    const std::int64_t base = body_z_tenth_mm / kBaseStep_tenth_mm * kBaseStep_tenth_mm;
    return static_cast<std::int32_t>(std::clamp(base, -kFarthest, kFarthest));
}

/// Returns the height above the base, rounded to the nearest mm (half a mm upwards) and saturated.
std::int16_t height_mm(std::int32_t height_tenth_mm, std::int32_t base_tenth_mm) noexcept {
    const std::int64_t over_base = static_cast<std::int64_t>(height_tenth_mm) - base_tenth_mm;
    const std::int64_t shifted = over_base + kTenthsPerMm / 2;
    const std::int64_t mm = (shifted - (shifted < 0 ? kTenthsPerMm - 1 : 0)) / kTenthsPerMm;
    constexpr std::int64_t kHighest = std::numeric_limits<std::int16_t>::max();
    return static_cast<std::int16_t>(std::clamp(mm, -kHighest, kHighest));
}

/// Returns true if an object above the cell hangs lower than the height of the machine, so the body
/// can hit it.
bool is_too_low(const grid::MapSnapshot& snapshot,
                std::size_t i,
                const ColourLimits& limits) noexcept {
    return snapshot.clearance_tenth_mm[i] < limits.machine_height_tenth_mm;
}

PageCell cell_of(const grid::MapSnapshot& snapshot,
                 int ix,
                 int iy,
                 std::int32_t base_tenth_mm,
                 const ColourLimits& limits) noexcept {
    const std::size_t i = element(ix, iy, snapshot.nx);
    PageCell cell;
    if (snapshot.is_measured(i)) {
        cell.height_mm = height_mm(snapshot.height_tenth_mm[i], base_tenth_mm);
        const std::int64_t sigma_mm =
            (snapshot.sigma_tenth_mm[i] + kTenthsPerMm - 1) / kTenthsPerMm;
        cell.sigma_mm = static_cast<std::uint8_t>(
            std::min<std::int64_t>(sigma_mm, PageCell::kSigmaSaturated_mm));
        cell.state = static_cast<std::uint8_t>(ground_state(snapshot, ix, iy, limits));
        if (snapshot.drop_evidence[i] >= limits.drop_evidence) cell.state |= kDropBit;
    }
    if (snapshot.source[i] == grid::EvidenceSource::attested) cell.state |= kAttestedBit;
    if (is_too_low(snapshot, i, limits)) cell.state |= kOverheadBit;
    return cell;
}

/// Offset of a cell of the new map in the old map, in cells.
struct Shift {
    std::int64_t x = 0;
    std::int64_t y = 0;
};

/// Computes the shift between two maps. Returns false if their cells do not coincide.
bool shift_between(const PageMap& before, const PageMap& now, Shift& shift) noexcept {
    if (before.nx != now.nx || before.ny != now.ny || before.cells.size() != now.cells.size() ||
        before.resolution_tenth_mm != now.resolution_tenth_mm ||
        before.base_z_tenth_mm != now.base_z_tenth_mm || now.resolution_tenth_mm <= 0)
        return false;
    const std::int64_t dx = now.origin_x_tenth_mm - before.origin_x_tenth_mm;
    const std::int64_t dy = now.origin_y_tenth_mm - before.origin_y_tenth_mm;
    if (dx % now.resolution_tenth_mm != 0 || dy % now.resolution_tenth_mm != 0) return false;
    shift = {dx / now.resolution_tenth_mm, dy / now.resolution_tenth_mm};
    return true;
}

struct Run {
    std::size_t first = 0;
    std::size_t count = 0;
};
/// The head of a run takes as many bytes as two cells. So the cells of a gap of up to two cells are
/// sent too.
constexpr std::size_t kRunBytes = 8;
constexpr std::size_t kBridged = kRunBytes / sizeof(PageCell);

/// Returns the runs of the cells for which `differs` is true, in order. Short gaps belong to a run.
template <typename Differs>
std::vector<Run> runs_of(const PageMap& map, const Differs& differs) {
    std::vector<Run> runs;
    std::size_t i = 0;
    for (int iy = 0; iy < map.ny; ++iy) {
        for (int ix = 0; ix < map.nx; ++ix, ++i) {
            if (!differs(ix, iy, map.cells[i])) continue;
            if (!runs.empty() && i - (runs.back().first + runs.back().count) <= kBridged) {
                runs.back().count = i + 1 - runs.back().first;
            } else {
                runs.push_back({i, 1});
            }
        }
    }
    return runs;
}

std::size_t bytes_of(const std::vector<Run>& runs) noexcept {
    std::size_t bytes = 0;
    for (const Run& run : runs) bytes += kRunBytes + run.count * sizeof(PageCell);
    return bytes;
}

std::vector<Run> known_cells(const PageMap& map) {
    return runs_of(map, [](int, int, const PageCell& cell) { return cell != PageCell{}; });
}

std::vector<Run> changed_cells(const PageMap& map, const PageMap& before, Shift shift) {
    return runs_of(map, [&](int ix, int iy, const PageCell& cell) {
        const std::int64_t x = ix + shift.x;
        const std::int64_t y = iy + shift.y;
        const bool was_there = x >= 0 && y >= 0 && x < before.nx && y < before.ny;
        const PageCell was =
            was_there ? before.cells[element(static_cast<int>(x), static_cast<int>(y), before.nx)]
                      : PageCell{};
        return cell != was;
    });
}

std::string encode(const PageMap& map, const std::vector<Run>& runs, bool whole) {
    constexpr std::size_t kHeaderBytes = 64;
    constexpr std::size_t kEdgeBytes = 24;
    std::string out;
    out.reserve(kHeaderBytes + map.edges.size() * kEdgeBytes + bytes_of(runs));
    MessageWriter write(out);
    write_header(write, MessageKind::map);
    write << map.version << map.frame_time_ns << map.origin_x_tenth_mm << map.origin_y_tenth_mm
          << map.base_z_tenth_mm << static_cast<std::uint32_t>(map.resolution_tenth_mm)
          << static_cast<std::uint16_t>(map.nx) << static_cast<std::uint16_t>(map.ny)
          << static_cast<std::uint8_t>(whole ? 1 : 0) << std::uint8_t{0}
          << static_cast<std::uint16_t>(map.edges.size())
          << static_cast<std::uint32_t>(runs.size());
    for (const grid::SnapshotEdge& edge : map.edges) {
        write << edge.from_x_tenth_mm << edge.from_y_tenth_mm << edge.to_x_tenth_mm
              << edge.to_y_tenth_mm << edge.upper_tenth_mm << edge.lower_tenth_mm;
    }
    for (const Run& run : runs) {
        write << static_cast<std::uint32_t>(run.first) << static_cast<std::uint32_t>(run.count);
        out.append(reinterpret_cast<const char*>(map.cells.data() + run.first),
                   run.count * sizeof(PageCell));
    }
    return out;
}

}  // namespace

ColourLimits colour_limits(const Machine& machine) noexcept {
    const StepLimits& walk = machine.limits.step[static_cast<std::size_t>(MovementClass::walk)];
    ColourLimits limits{machine.limits.cell_sigma_tenth_mm,
                        walk.up_tenth_mm,
                        walk.down_tenth_mm,
                        machine.limits.drop_evidence,
                        0};
    for (const BodyPart& part : machine.body.all())
        limits.machine_height_tenth_mm =
            std::max(limits.machine_height_tenth_mm, part.high_tenth_mm);
    return limits;
}

GroundState ground_state(const grid::MapSnapshot& snapshot,
                         int ix,
                         int iy,
                         const ColourLimits& limits) noexcept {
    const std::size_t i = element(ix, iy, snapshot.nx);
    if (!snapshot.is_measured(i)) return GroundState::unknown;
    const std::int64_t height = snapshot.height_tenth_mm[i];
    if (snapshot.sigma_tenth_mm[i] > limits.cell_sigma_tenth_mm) return GroundState::unsure;
    if (snapshot.drop_evidence[i] >= limits.drop_evidence) return GroundState::unsafe;
    if (is_too_low(snapshot, i, limits)) return GroundState::unsafe;
    struct Step {
        int x, y;
    };
    for (const Step step : {Step{1, 0}, Step{-1, 0}, Step{0, 1}, Step{0, -1}}) {
        const int x = ix + step.x;
        const int y = iy + step.y;
        if (x < 0 || y < 0 || x >= snapshot.nx || y >= snapshot.ny) continue;
        const std::size_t neighbour = element(x, y, snapshot.nx);
        if (!snapshot.is_measured(neighbour) ||
            snapshot.sigma_tenth_mm[neighbour] > limits.cell_sigma_tenth_mm)
            continue;
        const std::int64_t other = snapshot.height_tenth_mm[neighbour];
        if (other - height > limits.up_tenth_mm || height - other > limits.down_tenth_mm)
            return GroundState::unsafe;
    }
    return GroundState::free;
}

void fill_page_map(const grid::MapSnapshot& snapshot,
                   std::int64_t frame_time_ns,
                   const ColourLimits& limits,
                   PageMap& out) {
    out.version = snapshot.version;
    out.frame_time_ns = frame_time_ns;
    out.origin_x_tenth_mm = snapshot.origin_x_tenth_mm;
    out.origin_y_tenth_mm = snapshot.origin_y_tenth_mm;
    out.base_z_tenth_mm = base_near(snapshot.body_z_tenth_mm, out.base_z_tenth_mm);
    out.resolution_tenth_mm = snapshot.resolution_tenth_mm;
    out.nx = snapshot.nx;
    out.ny = snapshot.ny;
    out.edges.assign(snapshot.edges.begin(), snapshot.edges.begin() + snapshot.edge_count);
    out.cells.resize(element(0, snapshot.ny, snapshot.nx));
    for (int iy = 0; iy < snapshot.ny; ++iy) {
        for (int ix = 0; ix < snapshot.nx; ++ix) {
            out.cells[element(ix, iy, snapshot.nx)] =
                cell_of(snapshot, ix, iy, out.base_z_tenth_mm, limits);
        }
    }
}

std::string map_message(const PageMap& map, const PageMap* before) {
    const std::vector<Run> known = known_cells(map);
    Shift shift;
    if (before == nullptr || !shift_between(*before, map, shift)) return encode(map, known, true);
    const std::vector<Run> changed = changed_cells(map, *before, shift);
    if (bytes_of(changed) > bytes_of(known)) return encode(map, known, true);
    return encode(map, changed, false);
}

}  // namespace surefoot::page
