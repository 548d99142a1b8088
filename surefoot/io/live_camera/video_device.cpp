// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/live_camera/video_device.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

namespace surefoot::io {
namespace {

class KernelVideoDevice final : public VideoDevice {
  public:
    KernelVideoDevice() = default;
    ~KernelVideoDevice() override { KernelVideoDevice::close(); }
    KernelVideoDevice(const KernelVideoDevice&) = delete;
    KernelVideoDevice& operator=(const KernelVideoDevice&) = delete;

    int open(const std::string& path) override {
        close();
        descriptor_ = ::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
        if (descriptor_ < 0) return errno;
        struct stat status = {};
        if (::fstat(descriptor_, &status) == 0 && S_ISCHR(status.st_mode)) return 0;
        close();
        return ENOTTY;
    }
    void close() override {
        if (descriptor_ >= 0) ::close(descriptor_);
        descriptor_ = -1;
    }
    int request(unsigned long code, void* argument) override {
        int result = -1;
        do {
            result = ::ioctl(descriptor_, code, argument);
        } while (result < 0 && errno == EINTR);
        return result < 0 ? errno : 0;
    }
    const std::uint8_t* map(std::size_t offset, std::size_t length) override {
        void* address =
            ::mmap(nullptr, length, PROT_READ, MAP_SHARED, descriptor_, static_cast<off_t>(offset));
        return address == MAP_FAILED ? nullptr : static_cast<const std::uint8_t*>(address);
    }
    void unmap(const std::uint8_t* address, std::size_t length) override {
        ::munmap(const_cast<std::uint8_t*>(address), length);  // munmap takes no pointer to const
    }
    int wait(int timeout_ms) override {
        pollfd poll = {descriptor_, POLLIN, 0};
        const int count = ::poll(&poll, 1, timeout_ms);
        if (count < 0) return errno;
        if (count == 0) return ETIMEDOUT;
        return (poll.revents & POLLIN) != 0 ? 0 : ENODEV;
    }
    void pause(int time_ms) override { (void)::poll(nullptr, 0, time_ms); }

  private:
    int descriptor_ = -1;
};

}  // namespace

std::unique_ptr<VideoDevice> kernel_video_device() {
    return std::make_unique<KernelVideoDevice>();
}

}  // namespace surefoot::io
