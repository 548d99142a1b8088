// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "surefoot/core/result.hpp"
#include "surefoot/io/clouds/point_cloud.hpp"

namespace surefoot::io {

/// A cloud file that is written block by block: .ply, .pcd (both binary), or .xyz .asc .txt .csv as
/// text. It grows beside its place ("F.ply.part") and comes there whole when it is finished; one
/// that is not finished leaves nothing.
class CloudWriter {
  public:
    /// Errors: an extension that is none of these; what the system says.
    [[nodiscard]] static Result<CloudWriter> create(const std::string& path,
                                                    const CloudFormat& format = {});
    ~CloudWriter();
    CloudWriter(CloudWriter&& other) noexcept;
    CloudWriter& operator=(CloudWriter&&) = delete;

    /// All blocks have the colours and scalars of the first, with their types; another is an error.
    /// Coordinates are doubles where the format or the first block says so.
    [[nodiscard]] Status add(const PointCloud& block);
    [[nodiscard]] Status finish();
    [[nodiscard]] std::int64_t points() const noexcept { return points_; }
    /// What the format of the file does not hold of the blocks, a sentence each.
    [[nodiscard]] const std::vector<std::string>& notes() const noexcept { return notes_; }

  private:
    enum class Kind : std::uint8_t { ply, pcd, text };
    CloudWriter(std::string path, Kind kind, const CloudFormat& format, int descriptor)
        : path_(std::move(path)), kind_(kind), format_(format), descriptor_(descriptor) {}
    [[nodiscard]] std::string part_path() const { return path_ + ".part"; }
    [[nodiscard]] std::string head(std::int64_t points) const;
    void note_losses(const PointCloud& block);

    std::string path_;
    Kind kind_;
    CloudFormat format_;
    int descriptor_ = -1;
    std::string head_;  ///< of the first block
    PointCloud first_;  ///< the first block without its points: what all blocks hold
    std::vector<std::string> notes_;
    std::int64_t points_ = 0;
    std::int64_t size_ = 0;
};

}  // namespace surefoot::io
