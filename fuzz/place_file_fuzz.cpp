// SPDX-License-Identifier: Apache-2.0
// Any bytes give a valid place or an error with a message. A place that was read is the same after
// writing and reading it again.
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "fuzz/must.hpp"
#include "surefoot/io/bytes.hpp"
#include "surefoot/io/maps/map_file.hpp"
#include "surefoot/io/maps/place_file.hpp"

namespace {

using namespace surefoot;

void check(std::string_view bytes) {
    const auto read = io::parse_place(bytes, "f");
    must_explain(read);
    if (!read) return;
    must(!read->place.problem());
    const auto again = io::format_place(read->place);
    must(again.ok());
    const auto back = io::parse_place(*again, "again");
    must(back.ok() && *io::format_place(back->place) == *again);
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
