// SPDX-License-Identifier: Apache-2.0
#include "service/gate_process/audit/audit_disk.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <utility>

#include "surefoot/core/fnv1a.hpp"

namespace surefoot::gate_process {
namespace {

Error system_error(const std::string& what, int error) {
    return output_error(what + ": " + std::generic_category().message(error));
}

class FolderDisk final : public AuditDisk {
  public:
    explicit FolderDisk(std::string folder) : folder_(std::move(folder)) {}
    ~FolderDisk() override { close_file(); }

    Result<std::vector<Entry>> list() override {
        namespace fs = std::filesystem;
        std::error_code error;
        fs::create_directories(folder_, error);
        std::vector<Entry> entries;
        for (fs::directory_iterator it(folder_, error), end; !error && it != end;
             it.increment(error)) {
            std::error_code no_file;
            const std::uintmax_t bytes = it->file_size(no_file);
            if (!no_file) entries.push_back({it->path().filename().string(), bytes});
        }
        if (error) return output_error(folder_ + ": " + error.message());
        return entries;
    }
    Status create(const std::string& name) override {
        close_file();
        path_ = path_of(name);
        file_ = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_APPEND | O_CLOEXEC, 0640);
        if (file_ < 0) return system_error(path_, errno);
        return sync_folder();
    }
    Written write(std::string_view bytes) override {
        const ssize_t written = ::write(file_, bytes.data(), bytes.size());
        if (written >= 0) return {static_cast<std::size_t>(written), 0};
        return {0, errno == EINTR ? 0 : errno};
    }
    Status truncate(std::uint64_t bytes) override {
        if (::ftruncate(file_, static_cast<off_t>(bytes)) == 0) return {};
        return system_error(path_, errno);
    }
    Status sync() override {
        if (::fdatasync(file_) == 0) return {};
        return system_error(path_, errno);
    }
    void close() override { close_file(); }
    Status remove(const std::string& name) override {
        if (::unlink(path_of(name).c_str()) == 0 || errno == ENOENT) return {};
        return system_error(path_of(name), errno);
    }

  private:
    [[nodiscard]] std::string path_of(const std::string& name) const {
        return folder_ + "/" + name;
    }
    void close_file() noexcept {
        if (file_ >= 0) ::close(file_);
        file_ = -1;
    }
    /// A power loss can remove the name of a new file, unless its folder is synced too.
    [[nodiscard]] Status sync_folder() const {
        const int folder = ::open(folder_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
        if (folder < 0) return system_error(folder_, errno);
        // Some file systems cannot sync folders. The file exists even then.
        const bool failed = ::fsync(folder) != 0 && errno != EINVAL;
        const int error = errno;
        ::close(folder);
        return failed ? Status(system_error(folder_, error)) : Status();
    }

    std::string folder_;
    std::string path_;
    int file_ = -1;
};

}  // namespace

std::unique_ptr<AuditDisk> make_folder_disk(std::string folder) {
    return std::make_unique<FolderDisk>(std::move(folder));
}

std::uint64_t new_run_id() {
    std::string boot;
    std::ifstream("/proc/sys/kernel/random/boot_id") >> boot;
    const auto now = std::chrono::steady_clock::now().time_since_epoch().count();
    return fnv1a(fmt::format("{} {} {}", boot, now, ::getpid()));
}

}  // namespace surefoot::gate_process
