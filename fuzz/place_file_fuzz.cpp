// SPDX-License-Identifier: Apache-2.0
// Any bytes must end in a place without a problem or in an error with a sentence; what was read is
// written to bytes that read back the same.
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
    // Almost no input has the right checksum, so what lies behind it is tried as well.
    std::string sealed(bytes.substr(0, size < 8 ? 0 : size - 8));
    io::store_le(sealed, io::map_checksum(sealed));
    check(sealed);
    return 0;
}
