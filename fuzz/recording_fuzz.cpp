// SPDX-License-Identifier: Apache-2.0
// Lists of a recording from any bytes: stamps of images, pairs of images, IMU samples. Each text
// gives rows that a recording can use, or an error with a message. SUREFOOT_FUZZ_READER names the
// function under test.
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "fuzz/must.hpp"
#include "surefoot/io/raw_floats.hpp"
#include "surefoot/io/recordings/imu_stream.hpp"
#include "surefoot/io/recordings/pairing.hpp"
#include "surefoot/io/recordings/recording.hpp"

namespace {

using namespace surefoot;

/// In the year 2261. Sums and differences of two stamps up to here fit into 64 bits.
constexpr std::int64_t kLastStamp_ns = 9'200'000'000'000'000'000;
constexpr std::int64_t kTolerance_ns = 20'000'000;

void must_be_stamp(std::int64_t time_ns) {
    must(time_ns >= 0 && time_ns <= kLastStamp_ns);
}

std::size_t lines_of(std::string_view text) {
    return 1 + static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n') +
                                        std::count(text.begin(), text.end(), '\r'));
}

/// A row contains a valid stamp, a file name and a line number of the text.
void must_be_row(const io::CsvRow& row, std::string_view text) {
    must_be_stamp(row.time_ns);
    must(!row.value.empty());
    must(row.line >= 1 && static_cast<std::size_t>(row.line) <= lines_of(text));
}

/// Partners differ by at most the tolerance, and every image has at most one partner.
void must_pair(const std::vector<std::int64_t>& left_ns,
               const std::vector<std::int64_t>& right_ns) {
    const io::Partners partners = io::pair_by_time(left_ns, right_ns, kTolerance_ns);
    must(partners.size() == left_ns.size());
    std::vector<bool> used(right_ns.size(), false);
    for (std::size_t i = 0; i < partners.size(); ++i) {
        if (!partners[i]) continue;
        const std::size_t right = *partners[i];
        must(right < used.size() && !used[right]);
        must(std::abs(left_ns[i] - right_ns[right]) <= kTolerance_ns);
        used[right] = true;
    }
}

void must_be_rows(const Result<std::vector<io::CsvRow>>& rows, std::string_view text) {
    must_explain(rows);
    if (!rows) return;
    std::vector<std::int64_t> times_ns;
    std::vector<std::string> names;
    for (const io::CsvRow& row : *rows) {
        must_be_row(row, text);
        times_ns.push_back(row.time_ns);
        names.push_back(row.value);
    }
    // Pairs the first half with the second, as if two cameras had written them.
    const auto half = times_ns.begin() + static_cast<std::ptrdiff_t>(times_ns.size() / 2);
    must_pair({times_ns.begin(), half}, {half, times_ns.end()});
    must(io::fifth_of_frame_time_ns(times_ns) >= 0);
    if (const auto stamps = io::stamps_of_names(names))
        must(stamps->times_ns.size() == names.size());
}

[[maybe_unused]] void fuzz_tum_list(std::string_view bytes) {
    must_be_rows(io::parse_tum_list(bytes, "f"), bytes);
}
[[maybe_unused]] void fuzz_euroc_frames(std::string_view bytes) {
    must_be_rows(io::parse_euroc_frames(bytes, "f"), bytes);
}

/// The depth image of a row is in the column with that name.
[[maybe_unused]] void fuzz_associations(std::string_view bytes) {
    const auto rows = io::parse_associations(bytes, "f");
    must_explain(rows);
    if (!rows) return;
    const auto is_depth = [](const io::CsvRow& row) {
        return row.value.find("depth") != row.value.npos;
    };
    for (const io::AssociatedRow& row : *rows) {
        must_be_row(row.colour, bytes);
        must_be_row(row.depth, bytes);
        must(row.colour.line == row.depth.line);
        must(is_depth(row.depth) || !is_depth(row.colour));
    }
}

/// One stamp for each line that is not empty.
[[maybe_unused]] void fuzz_timestamps(std::string_view bytes) {
    const auto times_ns = io::parse_timestamps(bytes, "f");
    must_explain(times_ns);
    if (!times_ns) return;
    must(times_ns->size() <= lines_of(bytes));
    for (const std::int64_t time_ns : *times_ns) must_be_stamp(time_ns);
}

void must_be_samples(const std::vector<ImuSample>& samples) {
    for (std::size_t i = 0; i < samples.size(); ++i) {
        must_be_stamp(samples[i].time_ns);
        must(i == 0 || samples[i].time_ns > samples[i - 1].time_ns);
        must(samples[i].angular_velocity_rad_s.allFinite());
        must(samples[i].specific_force_m_s2.allFinite());
    }
}

/// The same rows from a whole file and from a growing one. The first byte chooses how many of the
/// stamps are there at the first reading.
[[maybe_unused]] void fuzz_imu_samples(std::string_view bytes) {
    if (bytes.empty()) return;
    const auto choice = static_cast<std::uint8_t>(bytes.front());
    bytes.remove_prefix(1);
    const auto whole = io::parse_euroc_imu_samples(bytes, "f");
    must_explain(whole);
    if (whole) must_be_samples(*whole);

    static const int file = ::memfd_create("imu", 0);
    static const std::string path = "/proc/self/fd/" + std::to_string(file);
    // A line is complete only with its line end.
    const std::string_view ended = bytes.substr(0, bytes.rfind('\n') + 1);
    const std::size_t cut = ended.empty() ? 0 : (choice * ended.size()) / 256;
    const auto write = [](std::string_view part, std::size_t at) {
        must(::pwrite(file, part.data(), part.size(), static_cast<off_t>(at)) ==
             static_cast<ssize_t>(part.size()));
    };
    must(::ftruncate(file, 0) == 0);
    write(ended.substr(0, cut), 0);
    auto stream = io::ImuStream::open(path);
    must(stream.ok());
    auto first = stream->take_until(kLastStamp_ns);
    must_explain(first);
    if (!first) return;
    write(ended.substr(cut), cut);
    const auto rest = stream->take_until(kLastStamp_ns);
    must_explain(rest);
    if (!whole) return;
    must(rest.ok());
    first->insert(first->end(), rest->begin(), rest->end());
    must_be_samples(*first);
    must(first->size() == io::parse_euroc_imu_samples(ended, "f")->size());
}

[[maybe_unused]] void fuzz_floats(std::string_view bytes) {
    const auto values = io::parse_floats(bytes, "f");
    must_explain(values);
    must(values.ok() == (bytes.size() % sizeof(float) == 0));
    must_explain(io::parse_floats(bytes, "f", 3));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    SUREFOOT_FUZZ_READER({reinterpret_cast<const char*>(data), size});
    return 0;
}
