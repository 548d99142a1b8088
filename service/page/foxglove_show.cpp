// SPDX-License-Identifier: Apache-2.0
#include "service/page/foxglove_show.hpp"

#include <fmt/format.h>

#include <utility>

namespace surefoot::page {
namespace {

/// Period of the status while no frame comes.
constexpr std::int64_t kStatusEvery_ns = 500'000'000;

}  // namespace

void FoxgloveShow::update(std::int64_t now_ns, const std::optional<PlaybackState>& playback) {
    if (status_frame_ == show_.serial() && now_ns < status_due_ns_) return;
    status_frame_ = show_.serial();
    status_due_ns_ = now_ns + kStatusEvery_ns;
    constexpr int kNotTold = 0;
    status_ = show_.status(now_ns, kNotTold, playback);
    ++status_serial_;
}

void FoxgloveShow::hear(GateNews news) {
    if (news.topic == GateTopic::outlook) {
        outlook_ = std::move(news.body);
        ++outlook_serial_;
        return;
    }
    verdicts_.push_back({++verdict_serial_, now_ns(), std::move(news.body)});
    if (verdicts_.size() > kRememberedVerdicts) verdicts_.pop_front();
}

std::uint64_t FoxgloveShow::serial(FoxgloveChannel channel) const {
    switch (channel) {
        case FoxgloveChannel::ground:
        case FoxgloveChannel::ground_points: return show_.map_serial;
        case FoxgloveChannel::camera: return show_.images_serial;
        case FoxgloveChannel::transforms:
        case FoxgloveChannel::pose: return show_.serial();
        case FoxgloveChannel::status: return status_serial_;
        case FoxgloveChannel::outlook: return outlook_serial_;
        case FoxgloveChannel::verdict: break;
    }
    return 0;
}

const std::string& FoxgloveShow::payload(FoxgloveChannel channel) {
    Made& made = made_[static_cast<std::size_t>(channel)];
    if (made.serial != serial(channel)) made = {serial(channel), make(channel)};
    return made.payload;
}

std::string FoxgloveShow::make(FoxgloveChannel channel) {
    const bool is_somewhere = show_.pose().T_odom_body.all_finite();
    switch (channel) {
        case FoxgloveChannel::ground: return ground_payload(show_.map);
        case FoxgloveChannel::ground_points: return ground_points_payload(show_.map);
        case FoxgloveChannel::camera: {
            const std::string& jpeg = show_.jpeg(PageImage::left);
            return jpeg.empty() ? "" : camera_payload(show_.images_time_ns(), jpeg);
        }
        case FoxgloveChannel::transforms:
            return is_somewhere ? transforms_payload(show_.pose(), show_.hello.T_body_camera) : "";
        case FoxgloveChannel::pose: return is_somewhere ? pose_payload(show_.pose()) : "";
        case FoxgloveChannel::status: return status_payload(status_, show_.pose().camera);
        case FoxgloveChannel::outlook: return outlook_;
        case FoxgloveChannel::verdict: break;
    }
    return {};
}

std::int64_t FoxgloveShow::time_ns(FoxgloveChannel channel) const {
    switch (channel) {
        case FoxgloveChannel::ground:
        case FoxgloveChannel::ground_points: return show_.map.frame_time_ns;
        case FoxgloveChannel::camera: return show_.images_time_ns();
        default: return now_ns();
    }
}

std::string FoxgloveShow::name() const {
    return fmt::format("{}, {}", show_.hello.program, show_.hello.source);
}

}  // namespace surefoot::page
