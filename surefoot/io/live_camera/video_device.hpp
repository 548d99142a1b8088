// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

namespace surefoot::io {

/// The system calls that a V4L2 camera needs; tests replace them by a scripted device. Calls return
/// 0 or an errno value. Not thread-safe.
class VideoDevice {
  public:
    virtual ~VideoDevice() = default;
    [[nodiscard]] virtual int open(const std::string& path) = 0;
    /// Closes the device; also ends streaming and releases the driver's buffers.
    virtual void close() = 0;
    /// Calls ioctl: `code` is VIDIOC_*, `argument` is the structure of this code.
    [[nodiscard]] virtual int request(unsigned long code, void* argument) = 0;
    /// Maps a buffer with mmap; returns null on failure.
    [[nodiscard]] virtual const std::uint8_t* map(std::size_t offset, std::size_t length) = 0;
    virtual void unmap(const std::uint8_t* address, std::size_t length) = 0;
    /// Returns 0 if a frame may be waiting, ETIMEDOUT, EINTR, or ENODEV if the device is gone.
    [[nodiscard]] virtual int wait(int timeout_ms) = 0;
    /// Waits before the next attempt to open; a signal ends the wait early.
    virtual void pause(int time_ms) = 0;
};

/// Returns the kernel's video device, not open yet.
[[nodiscard]] std::unique_ptr<VideoDevice> kernel_video_device();

}  // namespace surefoot::io
