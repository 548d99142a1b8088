// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/clouds/ply_stream.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

#include "surefoot/core/assert.hpp"
#include "surefoot/io/bytes.hpp"
#include "surefoot/io/write_at.hpp"

namespace surefoot::io {
Result<PlyStream> PlyStream::create(const std::string& path,
                                    const std::vector<std::string>& scalars) {
    const int descriptor =
        ::open(path.c_str(), O_CREAT | O_TRUNC | O_WRONLY | O_NONBLOCK | O_CLOEXEC, 0666);
    if (descriptor < 0) return cannot_write(path, errno);
    PlyStream stream(path, descriptor, scalars);
    if (Status status = write_at(stream.descriptor_, 0, stream.header(), stream.path_); !status)
        return status.error();
    return stream;
}

PlyStream::~PlyStream() {
    if (descriptor_ >= 0) ::close(descriptor_);
}

PlyStream::PlyStream(PlyStream&& other) noexcept
    : path_(std::move(other.path_)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      scalars_(std::move(other.scalars_)),
      points_(other.points_) {}

PlyStream& PlyStream::operator=(PlyStream&& other) noexcept {
    std::swap(path_, other.path_);
    std::swap(descriptor_, other.descriptor_);
    std::swap(scalars_, other.scalars_);
    std::swap(points_, other.points_);
    return *this;
}

/// Returns the header. A comment keeps the length of the header the same for every number of
/// points.
std::string PlyStream::header() const {
    constexpr int kDigits = 19;
    const std::string count = std::to_string(points_);
    std::string text =
        fmt::format("ply\nformat binary_little_endian 1.0\ncomment {:->{}}\nelement vertex {}\n",
                    "",
                    kDigits + 1 - static_cast<int>(count.size()),
                    count);
    for (const char* axis : {"x", "y", "z"}) text += fmt::format("property float {}\n", axis);
    for (const std::string& name : scalars_) text += fmt::format("property float {}\n", name);
    return text + "end_header\n";
}

Status PlyStream::add(std::span<const float> values) {
    const std::size_t properties = 3 + scalars_.size();
    SUREFOOT_ASSERT(values.size() % properties == 0);
    if (descriptor_ < 0) return output_error(fmt::format("{}: this file is closed already", path_));
    std::string bytes;
    bytes.reserve(values.size() * sizeof(float));
    for (const float value : values) store_le(bytes, value);
    const auto row = static_cast<std::int64_t>(properties * sizeof(float));
    const std::int64_t end = static_cast<std::int64_t>(header().size()) + row * points_;
    if (Status status = write_at(descriptor_, end, bytes, path_); !status) {
        // Truncation fails on devices. Ignore this failure: the write error below matters more.
        [[maybe_unused]] const int cut = ::ftruncate(descriptor_, static_cast<off_t>(end));
        return status;
    }
    points_ += static_cast<std::int64_t>(values.size() / properties);
    return write_at(descriptor_, 0, header(), path_);
}

Status PlyStream::close() {
    if (descriptor_ < 0) return {};
    const int error = ::close(std::exchange(descriptor_, -1)) == 0 ? 0 : errno;
    return error == 0 ? Status() : Status(cannot_write(path_, error));
}

}  // namespace surefoot::io
