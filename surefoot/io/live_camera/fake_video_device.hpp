// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <linux/videodev2.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <deque>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "surefoot/io/live_camera/video_device.hpp"

/// A scripted camera for tests: it answers the V4L2 requests as the kernel documents them, and
/// plays a script of frames and failures.
namespace surefoot::io::testing {

/// The next action of the driver.
struct FakeEvent {
    enum class Kind { frame, silence, unplug, unplug_while_dequeuing } kind = Kind::frame;
    std::string bytes = {};
    std::uint32_t sequence = 0;
    std::int64_t time_us = 0;
    std::uint32_t flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | V4L2_BUF_FLAG_TSTAMP_SRC_SOE;
};

struct FakeControl {
    int min = 0;
    int max = 0;
    int value = 0;
    std::uint32_t flags = 0;
};

class FakeCamera {
  public:
    std::uint32_t fourcc = V4L2_PIX_FMT_YUYV;
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    std::uint32_t bytes_per_line = 0;
    std::vector<std::uint32_t> rates_hz = {30};
    std::map<std::uint32_t, FakeControl> controls;
    std::uint32_t buffer_length = 1 << 16;
    bool keeps_its_own_size = false;  ///< S_FMT changes the width to half, as drivers may do
    int open_error = 0;               ///< error number of every attempt to open; 0 = success
    int absent_for = 0;               ///< number of failing attempts to open after an unplugging
    std::deque<FakeEvent> script;
    /// Counters that tests check.
    int opened = 0;
    int paused_ms = 0;
    int waited_ms = 0;
    int mapped = 0;  ///< number of buffers that are mapped now
};

class FakeVideoDevice final : public VideoDevice {
  public:
    explicit FakeVideoDevice(FakeCamera& camera) : camera_(&camera) {}

    int open(const std::string& /*path*/) override {
        if (camera_->open_error != 0) return camera_->open_error;
        if (gone_ && camera_->absent_for-- > 0) return ENODEV;
        gone_ = false;
        ++camera_->opened;
        return 0;
    }
    void close() override {
        streaming_ = false;
        queued_.clear();
    }
    const std::uint8_t* map(std::size_t offset, std::size_t length) override {
        const std::size_t slot = offset / camera_->buffer_length;
        if (slot >= memory_.size() || length != camera_->buffer_length) return nullptr;
        memory_[slot].resize(length);
        ++camera_->mapped;
        return memory_[slot].data();
    }
    void unmap(const std::uint8_t* /*address*/, std::size_t /*length*/) override {
        --camera_->mapped;
    }
    int wait(int timeout_ms) override {
        if (gone_ || !streaming_) return ENODEV;
        auto& script = camera_->script;
        const auto pass_time = [&] {
            camera_->waited_ms += timeout_ms;
            return ETIMEDOUT;
        };
        if (script.empty() || queued_.empty()) return pass_time();
        switch (script.front().kind) {
            case FakeEvent::Kind::silence: script.pop_front(); return pass_time();
            case FakeEvent::Kind::unplug:
                script.pop_front();
                gone_ = true;
                return ENODEV;
            default: return 0;
        }
    }
    void pause(int time_ms) override { camera_->paused_ms += time_ms; }

    int request(unsigned long code, void* argument) override {
        if (gone_) return ENODEV;
        switch (code) {
            case VIDIOC_QUERYCAP: return capability(*static_cast<v4l2_capability*>(argument));
            case VIDIOC_ENUM_FMT: return format(*static_cast<v4l2_fmtdesc*>(argument));
            case VIDIOC_ENUM_FRAMESIZES: return size(*static_cast<v4l2_frmsizeenum*>(argument));
            case VIDIOC_ENUM_FRAMEINTERVALS:
                return interval(*static_cast<v4l2_frmivalenum*>(argument));
            case VIDIOC_S_FMT: return set_format(*static_cast<v4l2_format*>(argument));
            case VIDIOC_S_PARM: return set_rate(*static_cast<v4l2_streamparm*>(argument));
            case VIDIOC_QUERYCTRL: return query(*static_cast<v4l2_queryctrl*>(argument));
            case VIDIOC_G_CTRL: return get(*static_cast<v4l2_control*>(argument));
            case VIDIOC_S_CTRL: return set(*static_cast<v4l2_control*>(argument));
            case VIDIOC_REQBUFS:
                memory_.resize(static_cast<v4l2_requestbuffers*>(argument)->count);
                return 0;
            case VIDIOC_QUERYBUF: return locate(*static_cast<v4l2_buffer*>(argument));
            case VIDIOC_QBUF:
                queued_.push_back(static_cast<v4l2_buffer*>(argument)->index);
                return 0;
            case VIDIOC_STREAMON: streaming_ = true; return 0;
            case VIDIOC_DQBUF: return dequeue(*static_cast<v4l2_buffer*>(argument));
            default: return ENOTTY;
        }
    }

  private:
    static void write(std::uint8_t* field, const char* text) {
        std::memcpy(field, text, std::strlen(text) + 1);
    }
    static int capability(v4l2_capability& out) {
        out.capabilities = V4L2_CAP_DEVICE_CAPS;
        out.device_caps = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
        write(out.card, "Fake stereo");
        write(out.driver, "fake");
        return 0;
    }
    int format(v4l2_fmtdesc& out) const {
        if (out.index > 0) return EINVAL;
        out.pixelformat = camera_->fourcc;
        return 0;
    }
    int size(v4l2_frmsizeenum& out) const {
        if (out.index > 0) return EINVAL;
        out.type = V4L2_FRMSIZE_TYPE_DISCRETE;
        out.discrete = {camera_->width, camera_->height};
        return 0;
    }
    int interval(v4l2_frmivalenum& out) const {
        if (out.index >= camera_->rates_hz.size()) return EINVAL;
        out.type = V4L2_FRMIVAL_TYPE_DISCRETE;
        out.discrete = {1, camera_->rates_hz[out.index]};
        return 0;
    }
    int set_format(v4l2_format& format) const {
        format.fmt.pix.width = camera_->keeps_its_own_size ? camera_->width / 2 : camera_->width;
        format.fmt.pix.height = camera_->height;
        format.fmt.pix.pixelformat = camera_->fourcc;
        format.fmt.pix.bytesperline = camera_->bytes_per_line;
        return 0;
    }
    int set_rate(v4l2_streamparm& parameters) const {
        v4l2_fract& time = parameters.parm.capture.timeperframe;
        const double wanted_hz =
            static_cast<double>(time.denominator) / static_cast<double>(time.numerator);
        const auto nearest = std::min_element(
            camera_->rates_hz.begin(), camera_->rates_hz.end(), [&](auto a, auto b) {
                return std::abs(a - wanted_hz) < std::abs(b - wanted_hz);
            });
        time = {1, *nearest};
        return 0;
    }
    int query(v4l2_queryctrl& out) const {
        auto found = camera_->controls.find(out.id);
        if ((out.id & V4L2_CTRL_FLAG_NEXT_CTRL) != 0)
            found = camera_->controls.upper_bound(out.id & ~V4L2_CTRL_FLAG_NEXT_CTRL);
        if (found == camera_->controls.end()) return EINVAL;
        out = {};
        out.id = found->first;
        out.type = V4L2_CTRL_TYPE_INTEGER;
        write(out.name, "Control");
        out.minimum = found->second.min;
        out.maximum = found->second.max;
        out.step = 1;
        out.flags = found->second.flags;
        return 0;
    }
    int get(v4l2_control& out) const {
        const auto found = camera_->controls.find(out.id);
        if (found == camera_->controls.end()) return EINVAL;
        out.value = found->second.value;
        return 0;
    }
    int set(const v4l2_control& in) {
        const auto found = camera_->controls.find(in.id);
        if (found == camera_->controls.end()) return EINVAL;
        if (in.value < found->second.min || in.value > found->second.max) return ERANGE;
        found->second.value = in.value;
        return 0;
    }
    int locate(v4l2_buffer& out) const {
        out.length = camera_->buffer_length;
        out.m.offset = out.index * camera_->buffer_length;
        return 0;
    }
    int dequeue(v4l2_buffer& out) {
        auto& script = camera_->script;
        if (script.empty() || queued_.empty()) return EAGAIN;
        const FakeEvent event = script.front();
        script.pop_front();
        if (event.kind == FakeEvent::Kind::unplug_while_dequeuing) {
            gone_ = true;
            return ENODEV;
        }
        out.index = queued_.front();
        queued_.pop_front();
        std::copy(event.bytes.begin(), event.bytes.end(), memory_[out.index].begin());
        out.bytesused = static_cast<std::uint32_t>(event.bytes.size());
        out.sequence = event.sequence;
        out.timestamp.tv_sec = event.time_us / 1'000'000;
        out.timestamp.tv_usec = event.time_us % 1'000'000;
        out.flags = event.flags;
        return 0;
    }

    FakeCamera* camera_;
    bool gone_ = false;
    bool streaming_ = false;
    std::deque<std::uint32_t> queued_;
    std::vector<std::vector<std::uint8_t>> memory_;
};

}  // namespace surefoot::io::testing
