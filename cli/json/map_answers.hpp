// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "surefoot/elevation/region/region_merge.hpp"
#include "surefoot/eval/maps/dem.hpp"
#include "surefoot/grid/grid_geometry.hpp"
#include "surefoot/ground/ground_observation.hpp"
#include "surefoot/io/maps/map_file.hpp"

// These functions write the JSON objects of the command line. The names of the keys are a contract
// (docs/reference/json.md). NaN is written as null.
namespace surefoot::app {

[[nodiscard]] std::string dem_json(const grid::GridGeometry& geometry,
                                   std::int64_t known_cells,
                                   const eval::CloudBounds& bounds,
                                   const std::string& file);
[[nodiscard]] std::string ground_json(const ground::GroundSighting& sighting);
[[nodiscard]] std::string rate_json(const grid::GridGeometry& geometry, const std::string& folder);
[[nodiscard]] std::string map_info_json(const io::MapFile& map, const std::string& file);
[[nodiscard]] std::string map_merge_json(const grid::MapRegion& merged,
                                         const elevation::MergeCounts& counts,
                                         const std::string& file);
[[nodiscard]] std::string map_export_json(const grid::MapRegion& region,
                                          const std::vector<std::string>& files,
                                          const std::string& folder);
[[nodiscard]] std::string fuse_json(std::size_t steps, const std::string& folder);

}  // namespace surefoot::app
