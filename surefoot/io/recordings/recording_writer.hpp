// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "surefoot/camera/stereo_rig.hpp"
#include "surefoot/core/frame.hpp"
#include "surefoot/core/result.hpp"

namespace surefoot::io {

/// One disk layout of recordings; the Recorder checks frames before it calls the writer. Images are
/// written before the lines that name them; the line that readers search first is written last.
class RecordingWriter {
  public:
    virtual ~RecordingWriter() = default;
    /// Creates the folders, calibration files and empty lists.
    [[nodiscard]] virtual Status start() = 0;
    [[nodiscard]] virtual Status add(const StereoFrame& frame) = 0;
    [[nodiscard]] virtual Status close() = 0;
    /// Reads the images written for the stamp of `frame`; false unless all are complete.
    [[nodiscard]] virtual bool read_back(StereoFrame& frame) const = 0;
    /// Returns the size of all written images [bytes].
    [[nodiscard]] virtual std::int64_t bytes() const noexcept = 0;
};

/// Returns the size of a written file [bytes]; 0 if the file does not exist.
[[nodiscard]] std::int64_t written_bytes(const std::string& path) noexcept;

[[nodiscard]] std::unique_ptr<RecordingWriter> make_euroc_writer(const std::string& folder,
                                                                 const camera::StereoRig& rig);
[[nodiscard]] std::unique_ptr<RecordingWriter> make_tum_writer(const std::string& folder,
                                                               const camera::StereoRig& rig);

}  // namespace surefoot::io
