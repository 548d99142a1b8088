// SPDX-License-Identifier: Apache-2.0
// Any bytes give a valid region or an error with a message. A region that was read can be written
// and read again, and merging it with itself does not make it more certain.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "fuzz/must.hpp"
#include "surefoot/elevation/region/region_merge.hpp"
#include "surefoot/io/bytes.hpp"
#include "surefoot/io/maps/map_file.hpp"

namespace {

using namespace surefoot;

void check(std::string_view bytes) {
    const auto read = io::parse_map(bytes, "f");
    must_explain(read);
    if (!read) return;
    must(!read->region.problem());
    const auto again = io::format_map(read->region);
    must(again.ok());
    const auto back = io::parse_map(*again, "again");
    must(back.ok() && *io::format_map(back->region) == *again);
    grid::MapRegion merged = read->region;
    must(elevation::merge(merged, read->region, {}).ok() && !merged.problem());
    for (std::size_t i = 0; i < merged.height_m.size(); ++i) {
        const float before_m2 = read->region.height_var_m2.data()[i];
        must(!(merged.height_var_m2.data()[i] < before_m2));
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view bytes(reinterpret_cast<const char*>(data), size);
    check(bytes);
    // Few inputs have a correct checksum, so the same bytes are tried with one as well.
    std::string sealed(bytes.substr(0, size < 8 ? 0 : size - 8));
    io::store_le(sealed, io::map_checksum(sealed));
    check(sealed);
    return 0;
}
