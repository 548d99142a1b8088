// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/clouds/cloud_writer.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <utility>

#include "surefoot/io/file.hpp"
#include "surefoot/io/text.hpp"
#include "surefoot/io/write_at.hpp"

namespace surefoot::io {
namespace {

/// Returns a comment line that is `times` characters shorter for each digit of the point count. The
/// header thus keeps its length.
std::string filler(const char* comment, std::int64_t points, int times) {
    constexpr int kDigits = 20;
    const int digits = static_cast<int>(std::to_string(points).size());
    return fmt::format("{} {:->{}}\n", comment, "", times * (kDigits - digits));
}

/// Replaces the number after a key at the beginning of a line.
void put_count(std::string& head, const std::string& key, std::int64_t points) {
    const std::size_t number = head.find("\n" + key + " ") + key.size() + 2;
    head.replace(number, head.find('\n', number) - number, std::to_string(points));
}

bool holds_the_same(const PointCloud& a, const PointCloud& b) {
    if (a.scalars.size() != b.scalars.size() || a.colours.empty() != b.colours.empty())
        return false;
    for (std::size_t i = 0; i < a.scalars.size(); ++i) {
        if (a.scalars[i].name != b.scalars[i].name ||
            a.scalars[i].values.index() != b.scalars[i].values.index())
            return false;
    }
    return true;
}

}  // namespace

Result<CloudWriter> CloudWriter::create(const std::string& path, const CloudFormat& format) {
    const std::string extension = extension_of(path);
    const bool text =
        is_text_cloud(extension) && extension != ".pts";  // .pts files need a different header
    if (!text && extension != ".ply" && extension != ".pcd") {
        return usage_error(fmt::format(
            "{}: clouds are written as .ply .pcd .xyz .asc .txt .csv, not '{}'", path, extension));
    }
    const Kind kind = text ? Kind::text : extension == ".ply" ? Kind::ply : Kind::pcd;
    CloudWriter writer(path, kind, format, -1);
    writer.descriptor_ = ::open(
        writer.part_path().c_str(), O_CREAT | O_TRUNC | O_WRONLY | O_NONBLOCK | O_CLOEXEC, 0666);
    if (writer.descriptor_ < 0) return cannot_write(path, errno);
    return writer;
}

CloudWriter::~CloudWriter() {
    if (descriptor_ < 0) return;
    ::close(descriptor_);
    ::unlink(part_path().c_str());
}

CloudWriter::CloudWriter(CloudWriter&& other) noexcept
    : path_(std::move(other.path_)),
      kind_(other.kind_),
      format_(other.format_),
      descriptor_(std::exchange(other.descriptor_, -1)),
      head_(std::move(other.head_)),
      first_(std::move(other.first_)),
      notes_(std::move(other.notes_)),
      points_(other.points_),
      size_(other.size_) {}

void CloudWriter::note_losses(const PointCloud& block) {
    if (kind_ != Kind::pcd && block.T_cloud_sensor &&
        !block.T_cloud_sensor->matrix().isIdentity(0.0)) {
        notes_.emplace_back(
            "the viewpoint of the cloud is not kept: only .pcd files can store a viewpoint");
    }
    if (kind_ != Kind::ply) return;
    for (const CloudScalar& scalar : block.scalars) {
        if (!std::holds_alternative<std::vector<std::int64_t>>(scalar.values) &&
            !std::holds_alternative<std::vector<std::uint64_t>>(scalar.values))
            continue;
        notes_.push_back(fmt::format(
            "{} has 64-bit whole numbers, which PLY cannot store. They are written as doubles, "
            "which are exact up to 2^53; write .pcd or text to keep larger numbers",
            quoted(scalar.name)));
    }
}

/// Returns the header. The length of the header does not depend on the number of points.
std::string CloudWriter::head(std::int64_t points) const {
    std::string head = head_;
    if (kind_ == Kind::ply) {
        put_count(head, "element vertex", points);
        const std::string_view end = "end_header\n";
        head.insert(head.size() - end.size(), filler("comment", points, 1));
    } else if (kind_ == Kind::pcd) {
        put_count(head, "WIDTH", points);
        put_count(head, "HEIGHT", 1);
        put_count(head, "POINTS", points);
        head.insert(0, filler("#", points, 2));
    }
    return head;
}

Status CloudWriter::add(const PointCloud& block) {
    if (descriptor_ < 0)
        return output_error(fmt::format("{}: this cloud is finished already", path_));
    if (const auto problem = block.problem()) return output_error(path_ + ": " + *problem);
    if (size_ == 0) {
        format_.double_precision = format_.double_precision || block.double_precision;
        first_.colours.assign(block.colours.empty() ? 0 : 1, Rgb{});
        for (const CloudScalar& scalar : block.scalars)
            first_.scalars.push_back(scalar.without_values());
        note_losses(block);
    } else if (!holds_the_same(first_, block)) {
        return output_error(
            fmt::format("{}: these points have other colours or scalars than the first points; "
                        "write them to another file",
                        path_));
    }
    const CloudFormat format{true, format_.double_precision};
    std::string bytes = kind_ == Kind::ply   ? format_ply(block, format)
                        : kind_ == Kind::pcd ? format_pcd(block, format)
                                             : format_text_cloud(block);
    const std::string_view last = kind_ == Kind::ply   ? "end_header\n"
                                  : kind_ == Kind::pcd ? "DATA binary\n"
                                                       : "\n";
    const std::size_t body = bytes.find(last) + last.size();
    if (size_ == 0) {
        head_ = bytes.substr(0, body);
        if (Status status = write_at(descriptor_, 0, head(0), path_); !status) return status;
        size_ = static_cast<std::int64_t>(head(0).size());
    }
    const std::string_view rows = std::string_view(bytes).substr(body);
    if (Status status = write_at(descriptor_, size_, rows, path_); !status) return status;
    size_ += static_cast<std::int64_t>(rows.size());
    points_ += static_cast<std::int64_t>(block.points_m.size());
    return {};
}

Status CloudWriter::finish() {
    if (descriptor_ < 0)
        return output_error(fmt::format("{}: this cloud is finished already", path_));
    if (size_ == 0) {
        if (Status status = add(PointCloud{}); !status) return status;
    }
    if (Status status = write_at(descriptor_, 0, head(points_), path_); !status) return status;
    if (::close(std::exchange(descriptor_, -1)) != 0) return cannot_write(path_, errno);
    if (std::rename(part_path().c_str(), path_.c_str()) == 0) return {};
    const int error = errno;
    ::unlink(part_path().c_str());
    return cannot_write(path_, error);
}

}  // namespace surefoot::io
