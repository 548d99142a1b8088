// SPDX-License-Identifier: Apache-2.0
#include "studies/simulation/scan_tiles.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "service/gate_process/protocol/json_text.hpp"
#include "surefoot/core/checked_index.hpp"
#include "surefoot/io/file.hpp"

namespace surefoot::app {
namespace {

using gate_process::dump_indented;
using gate_process::Json;

constexpr std::size_t kValuesPerPoint = 5;  // x y z station mixed
constexpr std::size_t kBlockPoints = 1U << 15U;
/// More tiles would exceed the limit of open files on common systems.
constexpr std::size_t kMostTiles = 500;

io::PointCloud empty_block() {
    io::PointCloud block;
    block.scalars = {{"station", {}}, {"mixed", {}}};
    return block;
}

std::string index_file(const std::string& folder) {
    return folder + "/index.json";
}

}  // namespace

Result<ScanTiles> ScanTiles::create(const std::string& folder,
                                    const std::string& format,
                                    double side_m) {
    if (auto status = io::make_folder(folder); !status) return status.error();
    if (auto status = io::remove_file(index_file(folder)); !status) return status.error();
    return ScanTiles(folder, format, side_m);
}

std::string ScanTiles::name_of(const Place& place) const {
    return fmt::format("tile_{}_{}.{}", place.first, place.second, format_);
}

Result<ScanTiles::Tile*> ScanTiles::tile_at(const Place& place) {
    const auto known = tiles_.find(place);
    if (known != tiles_.end()) return &known->second;
    if (tiles_.size() == kMostTiles) {
        return usage_error(
            fmt::format("--tile {:g}: the scan needs more than {} tiles; use larger tiles",
                        side_m_,
                        kMostTiles));
    }
    auto writer = io::CloudWriter::create(folder_ + "/" + name_of(place));
    if (!writer) return writer.error();
    return &tiles_.emplace(place, Tile{std::move(*writer), empty_block(), 0}).first->second;
}

Status ScanTiles::flush(Tile& tile) {
    if (tile.block.points_m.empty()) return {};
    tile.block.width = static_cast<int>(tile.block.points_m.size());
    tile.points += tile.block.width;
    points_ += tile.block.width;
    Status status = tile.writer.add(tile.block);
    tile.block = empty_block();
    return status;
}

Status ScanTiles::add(std::span<const float> values) {
    for (std::size_t i = 0; i + kValuesPerPoint <= values.size(); i += kValuesPerPoint) {
        const Eigen::Vector3d p_m(static_cast<double>(values[i]),
                                  static_cast<double>(values[i + 1]),
                                  static_cast<double>(values[i + 2]));
        const auto tile = tile_at({saturated_integer<int>(std::floor(p_m.x() / side_m_)),
                                   saturated_integer<int>(std::floor(p_m.y() / side_m_))});
        if (!tile) return tile.error();
        io::PointCloud& block = (*tile)->block;
        block.points_m.push_back(p_m);
        block.scalars[0].floats().push_back(values[i + 3]);
        block.scalars[1].floats().push_back(values[i + 4]);
        if (block.points_m.size() < kBlockPoints) continue;
        if (auto status = flush(**tile); !status) return status;
    }
    return {};
}

Status ScanTiles::finish(const ScanOrigin& origin) {
    Json files = Json::array();
    for (auto& [place, tile] : tiles_) {
        if (auto status = flush(tile); !status) return status;
        if (auto status = tile.writer.finish(); !status) return status;
        files.push_back({{"file", name_of(place)},
                         {"low_m", {place.first * side_m_, place.second * side_m_}},
                         {"points", tile.points}});
    }
    Json stations = Json::array();
    for (const Eigen::Vector3d& p_m : origin.stations_m)
        stations.push_back({p_m.x(), p_m.y(), p_m.z()});
    const Json index = {{"scene", origin.scene},
                        {"seed", origin.seed},
                        {"complete", origin.complete},
                        {"side_m", side_m_},
                        {"points", points_},
                        {"stations_m", stations},
                        {"tiles", files}};
    return io::write_file(index_file(folder_), dump_indented(index) + "\n");
}

}  // namespace surefoot::app
