// SPDX-License-Identifier: Apache-2.0
#include "io/cloud_stream.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "files/input_file.hpp"
#include "io/cloud_rows.hpp"
#include "io/file.hpp"

namespace surefoot::io {
namespace {

constexpr std::uint64_t kBlockRows = 1U << 16U;
constexpr std::size_t kBlockBytes = 4U << 20U;
/// Where the head of a file must end for its rows to be found.
constexpr std::size_t kHeadBytes = 1U << 16U;

}  // namespace

class CloudStream::Part {
  public:
    virtual ~Part() = default;
    virtual Result<PointCloud> next() = 0;
    virtual void rewind() = 0;
    [[nodiscard]] virtual std::optional<std::uint64_t> points() const { return std::nullopt; }
};

/// Rows of one size.
class CloudStream::Rows final : public Part {
  public:
    Rows(std::string path, files::InputFile file, CloudRows rows)
        : path_(std::move(path)), file_(std::move(file)), rows_(std::move(rows)) {}
    Result<PointCloud> next() override {
        const std::uint64_t count = std::min(kBlockRows, rows_.rows - next_);
        if (count == 0) return PointCloud{};
        auto bytes =
            file_.read_at(rows_.first_byte + next_ * rows_.row_bytes, count * rows_.row_bytes);
        if (!bytes) return bytes.error();
        next_ += count;
        return parse_cloud(rows_.head(count) + *bytes, path_);
    }
    void rewind() override { next_ = 0; }
    [[nodiscard]] std::optional<std::uint64_t> points() const override { return rows_.rows; }

  private:
    std::string path_;
    files::InputFile file_;
    CloudRows rows_;
    std::uint64_t next_ = 0;
};

/// Text with a point a line; a first line that names the columns stands before each piece.
class CloudStream::Lines final : public Part {
  public:
    Lines(std::string path, files::InputFile file)
        : path_(std::move(path)), file_(std::move(file)) {}
    Result<PointCloud> next() override {
        while (at_ < file_.size()) {
            auto bytes = file_.read_at(at_, kBlockBytes);
            if (!bytes) return bytes.error();
            if (at_ + bytes->size() < file_.size()) {
                const std::size_t end = bytes->rfind('\n');
                if (end == bytes->npos) {
                    return input_error(fmt::format(
                        "{}: a line of more than {} bytes is no point", path_, kBlockBytes));
                }
                bytes->resize(end + 1);
            }
            if (at_ == 0) {
                head_ = bytes->starts_with('/') || bytes->starts_with('#')
                            ? bytes->substr(0, bytes->find('\n')) + "\n"
                            : std::string();
            }
            const std::string piece = at_ == 0 ? *bytes : head_ + *bytes;
            const std::uint64_t begin = at_;
            at_ += bytes->size();
            if (!has_points(piece)) continue;
            auto cloud = parse_text_cloud(piece, path_);
            // Lines count from the beginning of the piece.
            if (!cloud && begin > 0) {
                return input_error(fmt::format(
                    "{} (lines counted from byte {} on)", cloud.error().message, begin));
            }
            any_ = true;
            return cloud;
        }
        if (!any_) return parse_text_cloud("", path_);
        return PointCloud{};
    }
    void rewind() override { at_ = 0; }

  private:
    static bool has_points(std::string_view text) {
        for (std::size_t begin = 0; begin < text.size();) {
            const std::size_t end = std::min(text.find('\n', begin), text.size());
            const std::size_t first = text.find_first_not_of(" \t\r", begin);
            if (first < end && text[first] != '#' && text.substr(first, 2) != "//") return true;
            begin = end + 1;
        }
        return false;
    }
    std::string path_;
    files::InputFile file_;
    std::string head_;
    std::uint64_t at_ = 0;
    bool any_ = false;
};

/// What cannot be cut.
class CloudStream::Whole final : public Part {
  public:
    explicit Whole(PointCloud cloud) : cloud_(std::move(cloud)) {}
    Result<PointCloud> next() override {
        const std::size_t count =
            std::min(static_cast<std::size_t>(kBlockRows), cloud_.points_m.size() - next_);
        PointCloud block;
        const auto part = [&](const auto& all) {
            const auto first = all.begin() + static_cast<std::ptrdiff_t>(next_);
            return std::decay_t<decltype(all)>(first, first + static_cast<std::ptrdiff_t>(count));
        };
        block.points_m = part(cloud_.points_m);
        if (!cloud_.colours.empty()) block.colours = part(cloud_.colours);
        for (const CloudScalar& scalar : cloud_.scalars)
            block.scalars.push_back({scalar.name, part(scalar.values)});
        block.width = static_cast<int>(count);
        next_ += count;
        return block;
    }
    void rewind() override { next_ = 0; }
    [[nodiscard]] std::optional<std::uint64_t> points() const override {
        return cloud_.points_m.size();
    }

  private:
    PointCloud cloud_;
    std::size_t next_ = 0;
};

CloudStream::CloudStream(std::unique_ptr<Part> part) : part_(std::move(part)) {}
CloudStream::~CloudStream() = default;
CloudStream::CloudStream(CloudStream&&) noexcept = default;
CloudStream& CloudStream::operator=(CloudStream&&) noexcept = default;

Result<CloudStream> CloudStream::open(const std::string& path) {
    const std::string extension = extension_of(path);
    auto file = files::InputFile::open(path, files::limits::kStreamBytes);
    if (!file) return file.error();
    if (is_text_cloud(extension))
        return CloudStream(std::make_unique<Lines>(path, std::move(file).value()));
    const auto head = file->read_at(0, kHeadBytes);
    if (!head) return head.error();
    auto rows = extension == ".ply"   ? ply_rows(*head, file->size())
                : extension == ".pcd" ? pcd_rows(*head, file->size())
                : extension == ".las" ? las_rows(*head, file->size())
                                      : std::nullopt;
    if (rows) {
        return CloudStream(
            std::make_unique<Rows>(path, std::move(file).value(), std::move(rows).value()));
    }
    auto cloud = read_cloud(path);  // or the reason why not
    if (!cloud) return cloud.error();
    return CloudStream(std::make_unique<Whole>(std::move(cloud).value()));
}

Result<PointCloud> CloudStream::next() {
    return part_->next();
}
void CloudStream::rewind() {
    part_->rewind();
}
std::optional<std::uint64_t> CloudStream::points() const {
    return part_->points();
}

Eigen::Vector3d shift_for(const Eigen::Vector3d& first_m) {
    constexpr double kNear_m = 1000.0;
    constexpr double kRound_m = 100.0;
    return first_m.unaryExpr([](double c_m) {
        return std::abs(c_m) < kNear_m ? 0.0 : kRound_m * std::round(c_m / kRound_m);
    });
}

Result<std::optional<Eigen::Vector3f>> ShiftedReader::shifted(const Eigen::Vector3d& p_m) {
    constexpr double kFar_m = 1e5;
    if (!p_m.allFinite()) {
        ++skipped_;
        return std::optional<Eigen::Vector3f>();
    }
    if (!shift_m_) shift_m_ = shift_for(p_m);
    const Eigen::Vector3d off_m = p_m - *shift_m_;
    if (off_m.cwiseAbs().maxCoeff() > kFar_m) {
        return input_error(
            fmt::format("{}: the point ({:g}, {:g}, {:g}) m is more than 100 km from the others, "
                        "which begin near ({:g}, {:g}, {:g}): remove stray points, or check the "
                        "unit",
                        path_,
                        p_m.x(),
                        p_m.y(),
                        p_m.z(),
                        shift_m_->x(),
                        shift_m_->y(),
                        shift_m_->z()));
    }
    return std::optional<Eigen::Vector3f>(off_m.cast<float>());
}

Status ShiftedReader::add(const PointCloud& block, std::vector<Eigen::Vector3f>& out) {
    for (const Eigen::Vector3d& p_m : block.points_m) {
        auto point_m = shifted(p_m);
        if (!point_m) return point_m.error();
        if (*point_m) out.push_back(**point_m);
    }
    return {};
}

Result<ShiftedCloud> read_shifted(const std::string& path,
                                  const std::optional<Eigen::Vector3d>& shift_m) {
    auto stream = CloudStream::open(path);
    if (!stream) return stream.error();
    ShiftedReader reader(path, shift_m);
    ShiftedCloud cloud;
    cloud.points_m.reserve(static_cast<std::size_t>(stream->points().value_or(0)));
    const auto status = stream->each_block(
        [&](const PointCloud& block) { return reader.add(block, cloud.points_m); });
    if (!status) return status.error();
    cloud.shift_m = reader.shift_m();
    cloud.skipped = reader.skipped();
    if (cloud.points_m.empty()) {
        return input_error(
            fmt::format("{}: no point with finite coordinates among {}", path, cloud.skipped));
    }
    return cloud;
}

}  // namespace surefoot::io
