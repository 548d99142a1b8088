// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/clouds/cloud_stream.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "surefoot/files/input_file.hpp"
#include "surefoot/io/clouds/cloud_rows.hpp"
#include "surefoot/io/clouds/text_cloud.hpp"
#include "surefoot/io/file.hpp"

namespace surefoot::io {
namespace {

constexpr std::uint64_t kBlockRows = 1U << 16U;
constexpr std::size_t kBlockBytes = 4U << 20U;
/// The header must end within this number of bytes. Otherwise the file is read whole.
constexpr std::size_t kHeadBytes = 1U << 16U;

}  // namespace

class CloudStream::Part {
  public:
    virtual ~Part() = default;
    virtual Result<PointCloud> next() = 0;
    virtual void rewind() = 0;
    [[nodiscard]] virtual std::optional<std::uint64_t> points() const { return std::nullopt; }
    [[nodiscard]] virtual std::vector<std::string> notes() const = 0;
};

/// Reads a file whose points are rows of one size, block by block.
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
        auto block = parse_cloud(rows_.head(count) + *bytes, path_);
        if (!block) return block;
        for (std::string& note : block->notes)
            if (std::find(notes_.begin(), notes_.end(), note) == notes_.end())
                notes_.push_back(std::move(note));
        block->notes.clear();
        return block;
    }
    void rewind() override { next_ = 0; }
    [[nodiscard]] std::optional<std::uint64_t> points() const override { return rows_.rows; }
    [[nodiscard]] std::vector<std::string> notes() const override { return notes_; }

  private:
    std::string path_;
    files::InputFile file_;
    CloudRows rows_;
    std::vector<std::string> notes_;  ///< notes of the blocks so far, each note once
    std::uint64_t next_ = 0;
};

/// Reads a text file with one point per line, block by block.
class CloudStream::Lines final : public Part {
  public:
    Lines(std::string path, files::InputFile file)
        : path_(std::move(path)), file_(std::move(file)), parser_(path_) {}
    Result<PointCloud> next() override {
        while (at_ < file_.size()) {
            auto bytes = file_.read_at(at_, kBlockBytes);
            if (!bytes) return bytes.error();
            if (at_ + bytes->size() < file_.size()) {
                const std::size_t feed = bytes->rfind('\n');
                const std::size_t end = feed != bytes->npos ? feed : bytes->rfind('\r');
                if (end == bytes->npos) {
                    return input_error(
                        fmt::format("{}: a line has more than {} bytes and cannot be a point; "
                                    "check that this is a text cloud",
                                    path_,
                                    kBlockBytes));
                }
                bytes->resize(end + 1);
            }
            at_ += bytes->size();
            auto cloud = parser_.parse(*bytes);
            if (!cloud || !cloud->points_m.empty()) return cloud;
        }
        if (Status status = parser_.finish(); !status) return status.error();
        return PointCloud{};
    }
    void rewind() override {
        at_ = 0;
        parser_ = TextCloudParser(path_);
    }
    [[nodiscard]] std::vector<std::string> notes() const override { return parser_.notes(); }

  private:
    std::string path_;
    files::InputFile file_;
    TextCloudParser parser_;
    std::uint64_t at_ = 0;
};

/// Holds a cloud that must be read whole.
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
        for (const CloudScalar& scalar : cloud_.scalars) {
            block.scalars.push_back(scalar.without_values());
            block.scalars.back().append(scalar, next_, count);
        }
        block.width = static_cast<int>(count);
        block.T_cloud_sensor = cloud_.T_cloud_sensor;
        block.double_precision = cloud_.double_precision;
        next_ += count;
        return block;
    }
    void rewind() override { next_ = 0; }
    [[nodiscard]] std::optional<std::uint64_t> points() const override {
        return cloud_.points_m.size();
    }
    [[nodiscard]] std::vector<std::string> notes() const override { return cloud_.notes; }

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
    auto cloud = read_cloud(path);  // a damaged file gives an error here
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
std::vector<std::string> CloudStream::notes() const {
    return part_->notes();
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
        return input_error(fmt::format(
            "{}: the point ({:g}, {:g}, {:g}) m is more than 100 km away from the origin of the "
            "other points, ({:g}, {:g}, {:g}) m: remove stray points, or check the unit",
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
        return input_error(fmt::format(
            "{}: no point with finite coordinates ({} points in the file); check the file",
            path,
            cloud.skipped));
    }
    return cloud;
}

}  // namespace surefoot::io
