// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/recordings/imu_stream.hpp"

#include <fmt/format.h>

#include <array>
#include <utility>

#include "surefoot/io/recordings/recording.hpp"

namespace surefoot::io {
namespace {

/// Largest length of a line [bytes]. An IMU row has seven numbers of at most 24 digits, so a longer
/// line is not an IMU row.
constexpr std::size_t kMaxLine = 4096;

class SourceWithImu final : public camera::FrameSource {
  public:
    SourceWithImu(std::unique_ptr<camera::FrameSource> source, ImuStream imu)
        : source_(std::move(source)), imu_(std::move(imu)), info_(source_->info()) {
        info_.has_imu = true;
    }
    [[nodiscard]] const camera::StereoRig& rig() const override { return source_->rig(); }
    [[nodiscard]] const camera::SourceInfo& info() const override { return info_; }
    [[nodiscard]] Result<std::optional<StereoFrame>> next() override {
        Result<std::optional<StereoFrame>> frame = source_->next();
        info_.broken = source_->info().broken;
        if (!frame || !frame->has_value()) return frame;
        Result<std::vector<ImuSample>> samples = imu_.take_until((*frame)->time_ns);
        if (!samples) return samples.error();
        if (first_) {
            const std::int64_t oldest_ns = (*frame)->time_ns - kFirstImuSpan_ns;
            std::erase_if(*samples,
                          [&](const ImuSample& sample) { return sample.time_ns <= oldest_ns; });
        }
        first_ = false;
        (*frame)->imu = std::move(samples).value();
        return frame;
    }

  private:
    std::unique_ptr<camera::FrameSource> source_;
    ImuStream imu_;
    camera::SourceInfo info_;
    bool first_ = true;
};

}  // namespace

Result<ImuStream> ImuStream::open(const std::string& path) {
    Result<files::InputFile> file =
        files::InputFile::open(path, files::limits::kStreamBytes, files::Accept::regular_or_fifo);
    if (!file) return file.error();
    return ImuStream(std::move(file).value());
}

Result<bool> ImuStream::read_some() {
    std::array<char, 1 << 14> chunk{};
    const Result<files::InputFile::Piece> piece = file_.read(chunk);
    if (!piece) return piece.error();
    if (piece->bytes == 0) return false;
    unread_.append(chunk.data(), piece->bytes);
    const std::size_t end = unread_.rfind('\n');
    const std::size_t whole = end == unread_.npos ? 0 : end + 1;
    if (unread_.size() - whole > kMaxLine)
        return input_error(file_.path() +
                           ": a line is too long; give IMU rows 'stamp_ns,wx,wy,wz,ax,ay,az'");
    const auto samples =
        parse_euroc_imu_samples(std::string_view(unread_).substr(0, whole), file_.path());
    if (!samples) return samples.error();
    unread_.erase(0, whole);
    for (const ImuSample& sample : *samples) {
        if (sample.time_ns <= last_time_ns_) {
            return input_error(
                fmt::format("{}: IMU time stamp {} ns does not increase: the previous one is {} ns",
                            file_.path(),
                            sample.time_ns,
                            last_time_ns_));
        }
        last_time_ns_ = sample.time_ns;
        waiting_.push_back(sample);
    }
    return true;
}

Result<std::vector<ImuSample>> ImuStream::take_until(std::int64_t time_ns) {
    while (last_time_ns_ <= time_ns) {
        const Result<bool> more = read_some();
        if (!more) return more.error();
        if (!*more) break;
    }
    std::vector<ImuSample> samples;
    for (; !waiting_.empty() && waiting_.front().time_ns <= time_ns; waiting_.pop_front())
        samples.push_back(waiting_.front());
    return samples;
}

Result<std::unique_ptr<camera::FrameSource>> with_imu(std::unique_ptr<camera::FrameSource> source,
                                                      const std::string& imu_path) {
    const std::string& path = source->info().path;
    if (source->info().has_imu) {
        return usage_error(
            fmt::format("--imu {}: {} has its own IMU; remove the option --imu", imu_path, path));
    }
    if (!source->rig().imu) {
        return usage_error(fmt::format(
            "--imu {}: the rig of {} does not say where its IMU is; add the key 'imu' to rig.yaml",
            imu_path,
            path));
    }
    Result<ImuStream> imu = ImuStream::open(imu_path);
    if (!imu) return imu.error();
    return std::unique_ptr<camera::FrameSource>(
        std::make_unique<SourceWithImu>(std::move(source), std::move(imu).value()));
}

}  // namespace surefoot::io
