// SPDX-License-Identifier: Apache-2.0
#include "studies/clouds/voxel_stream.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <vector>

#include "surefoot/eval/clouds/voxels.hpp"
#include "surefoot/io/clouds/cloud_stream.hpp"
#include "surefoot/io/clouds/cloud_writer.hpp"
#include "surefoot/io/file.hpp"

namespace surefoot::app {
namespace {

using Eigen::Vector3f;

/// Thickness of a slab along x, in voxels.
constexpr std::int64_t kSlabVoxels = 64;
constexpr std::int64_t kWritten = 1 << 16;  ///< number of points per call of the writer

std::int64_t slab_of(const Vector3f& p_m, double size_m) {
    const std::int64_t number = eval::voxel_number(p_m.x(), size_m);
    return number >= 0 ? number / kSlabVoxels : -((kSlabVoxels - 1 - number) / kSlabVoxels);
}

/// Reads a cloud as float points relative to a shift that is the same for all points.
class Source {
  public:
    static Result<Source> open(const std::string& path) {
        auto stream = io::CloudStream::open(path);
        if (!stream) return stream.error();
        return Source(path, std::move(stream).value());
    }
    /// Calls `use` with the points, block by block. `use` returns a Status.
    template <typename Use>
    Status each_block(const Use& use) {
        io::ShiftedReader reader(path_, shift_m_);
        std::vector<Vector3f> points_m;
        Status status = stream_.each_block([&](const io::PointCloud& block) -> Status {
            points_m.clear();
            if (notes_.empty()) note_losses(block);
            if (auto added = reader.add(block, points_m); !added) return added;
            return use(points_m);
        });
        if (!status) return status;
        if (!shift_m_) shift_m_ = reader.shift_m();
        skipped_ = reader.skipped();
        return {};
    }
    [[nodiscard]] Eigen::Vector3d shift_m() const {
        return shift_m_.value_or(Eigen::Vector3d::Zero());
    }
    [[nodiscard]] std::int64_t skipped() const noexcept { return skipped_; }
    [[nodiscard]] const std::vector<std::string>& notes() const noexcept { return notes_; }

  private:
    /// Adds a note about properties that the output lacks. The mean of several points has no
    /// colour, no value and no viewpoint.
    void note_losses(const io::PointCloud& block) {
        std::string lost = block.colours.empty() ? "" : "colours";
        const auto add = [&](const std::string& name) {
            lost += (lost.empty() ? "" : ", ") + name;
        };
        for (const io::CloudScalar& scalar : block.scalars) add(scalar.name);
        if (block.T_cloud_sensor) add("viewpoint");
        if (!lost.empty()) notes_.push_back("only positions are kept; the output lacks: " + lost);
    }
    Source(std::string path, io::CloudStream stream)
        : path_(std::move(path)), stream_(std::move(stream)) {}
    std::string path_;
    io::CloudStream stream_;
    std::optional<Eigen::Vector3d> shift_m_;
    std::int64_t skipped_ = 0;
    std::vector<std::string> notes_;
};

/// The number of points in each slab, and the bounding box of all points.
struct Census {
    std::map<std::int64_t, std::int64_t> by_slab;
    std::int64_t points = 0;
    geometry::PointBox box;
};

Result<Census> count(Source& source, const std::string& cloud, double size_m) {
    Census census;
    const auto status = source.each_block([&](const std::vector<Vector3f>& points_m) -> Status {
        for (const Vector3f& p_m : points_m) {
            if (census.points++ == 0) census.box = {p_m, p_m};
            census.box.low_m = census.box.low_m.cwiseMin(p_m);
            census.box.high_m = census.box.high_m.cwiseMax(p_m);
            ++census.by_slab[slab_of(p_m, size_m)];
        }
        return {};
    });
    if (!status) return status.error();
    if (census.points == 0) {
        return input_error(fmt::format(
            "{}: no point with finite coordinates ({} points in the file); check the file",
            cloud,
            source.skipped()));
    }
    if (auto fits = check_voxels(census.box, size_m, cloud); !fits) return fits.error();
    return census;
}

/// Splits the slabs into runs of at most `most` points. A run of a single slab may have more
/// points. Returns the first slab of each run.
std::vector<std::int64_t> runs_of(const Census& census, std::int64_t most) {
    std::vector<std::int64_t> first;
    std::int64_t in_run = 0;
    for (const auto& [slab, points] : census.by_slab) {
        if (first.empty() || in_run + points > most) {
            first.push_back(slab);
            in_run = 0;
        }
        in_run += points;
    }
    return first;
}

/// Temporary files of points in their own folder. The destructor removes the folder.
class Scratch {
  public:
    Scratch(std::string folder, std::size_t files) : folder_(std::move(folder)), files_(files) {}
    ~Scratch() {
        files_.clear();
        std::error_code ignored;
        std::filesystem::remove_all(folder_, ignored);
    }
    Scratch(const Scratch&) = delete;
    Scratch& operator=(const Scratch&) = delete;

    Status open() {
        if (auto status = io::make_folder(folder_); !status) return status;
        for (std::size_t i = 0; i < files_.size(); ++i) {
            files_[i].open(name(i),
                           std::ios::binary | std::ios::in | std::ios::out | std::ios::trunc);
            if (!files_[i]) return output_error(fmt::format("{}: cannot write", name(i)));
        }
        return {};
    }
    Status add(std::size_t file, std::span<const Vector3f> points_m) {
        files_[file].write(reinterpret_cast<const char*>(points_m.data()),
                           static_cast<std::streamsize>(points_m.size_bytes()));
        if (files_[file]) return {};
        return output_error(
            fmt::format("{}: this temporary file cannot take {} more bytes; check whether the disk "
                        "is full and run again",
                        name(file),
                        points_m.size_bytes()));
    }
    /// Returns all points of a file and deletes the file.
    Result<std::vector<Vector3f>> take(std::size_t file) {
        std::fstream& from = files_[file];
        from.flush();
        const auto bytes = static_cast<std::uint64_t>(std::filesystem::file_size(name(file)));
        std::vector<Vector3f> points_m(bytes / sizeof(Vector3f));
        from.seekg(0);
        from.read(reinterpret_cast<char*>(points_m.data()), static_cast<std::streamsize>(bytes));
        if (!from)
            return input_error(fmt::format(
                "{}: this temporary file cannot be read back; check the disk and run again",
                name(file)));
        from.close();
        std::filesystem::remove(name(file));
        return points_m;
    }

  private:
    [[nodiscard]] std::string name(std::size_t i) const {
        return fmt::format("{}/{}.f32", folder_, i);
    }
    std::string folder_;
    std::vector<std::fstream> files_;
};

Status deal_out(Source& source,
                const std::vector<std::int64_t>& first_slab,
                double size_m,
                Scratch& scratch) {
    std::vector<std::vector<Vector3f>> dealt(first_slab.size());
    return source.each_block([&](const std::vector<Vector3f>& points_m) -> Status {
        for (auto& some : dealt) some.clear();
        for (const Vector3f& p_m : points_m) {
            const auto after =
                std::upper_bound(first_slab.begin(), first_slab.end(), slab_of(p_m, size_m));
            dealt[static_cast<std::size_t>(after - first_slab.begin()) - 1].push_back(p_m);
        }
        for (std::size_t i = 0; i < dealt.size(); ++i) {
            if (auto status = scratch.add(i, dealt[i]); !status) return status;
        }
        return {};
    });
}

Status write_points(std::span<const Vector3f> points_m,
                    const Eigen::Vector3d& shift_m,
                    io::CloudWriter& writer) {
    for (std::size_t from = 0; from < points_m.size(); from += kWritten) {
        io::PointCloud block;
        const std::size_t end = std::min(from + kWritten, points_m.size());
        for (std::size_t i = from; i < end; ++i)
            block.points_m.emplace_back(points_m[i].cast<double>() + shift_m);
        block.width = static_cast<int>(block.points_m.size());
        if (auto status = writer.add(block); !status) return status;
    }
    return {};
}

}  // namespace

Status check_voxels(const geometry::PointBox& box, double size_m, const std::string& cloud) {
    if (eval::fits_voxels(box, size_m)) return {};
    const Eigen::Vector3d side_m = (box.high_m - box.low_m).cast<double>();
    return usage_error(
        fmt::format("{}: the cloud measures {:g} x {:g} x {:g} m, which is too large for voxels of "
                    "{:g} m; choose larger voxels, or remove stray points",
                    cloud,
                    side_m.x(),
                    side_m.y(),
                    side_m.z(),
                    size_m));
}

Result<ThinnedCloud> thin_cloud(const std::string& cloud,
                                double size_m,
                                const std::string& out_file,
                                Executor& executor,
                                std::int64_t most_in_memory) {
    auto source = Source::open(cloud);
    if (!source) return source.error();
    const auto census = count(*source, cloud, size_m);
    if (!census) return census.error();
    auto writer = io::CloudWriter::create(out_file, {true, !source->shift_m().isZero()});
    if (!writer) return writer.error();
    const auto write = [&](std::span<const Vector3f> points_m) {
        return write_points(
            eval::voxel_means_m(points_m, size_m, executor), source->shift_m(), *writer);
    };
    if (census->points <= most_in_memory) {
        std::vector<Vector3f> all_m;
        all_m.reserve(static_cast<std::size_t>(census->points));
        const auto status = source->each_block([&](const std::vector<Vector3f>& points_m) {
            all_m.insert(all_m.end(), points_m.begin(), points_m.end());
            return Status();
        });
        if (!status) return status.error();
        if (auto written = write(all_m); !written) return written.error();
    } else {
        const std::vector<std::int64_t> runs = runs_of(*census, most_in_memory / 2);
        Scratch scratch(out_file + ".scratch", runs.size());
        if (auto status = scratch.open(); !status) return status.error();
        if (auto status = deal_out(*source, runs, size_m, scratch); !status) return status.error();
        for (std::size_t i = 0; i < runs.size(); ++i) {
            const auto points_m = scratch.take(i);
            if (!points_m) return points_m.error();
            if (auto written = write(*points_m); !written) return written.error();
        }
    }
    const std::int64_t voxels = writer->points();
    if (auto status = writer->finish(); !status) return status.error();
    return ThinnedCloud{
        census->points, source->skipped(), voxels, source->shift_m(), source->notes()};
}

}  // namespace surefoot::app
