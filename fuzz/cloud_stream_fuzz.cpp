// SPDX-License-Identifier: Apache-2.0
// For any bytes, reading a cloud block by block gives the same points as reading it at once. The
// first byte chooses the format.
#include <fcntl.h>
#include <unistd.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include "fuzz/must.hpp"
#include "surefoot/io/clouds/cloud_stream.hpp"
#include "surefoot/io/clouds/point_cloud.hpp"

namespace {

using namespace surefoot;

/// A temporary file with this extension; removed at the end of the program.
class File {
  public:
    explicit File(const char* extension)
        : path_("/dev/shm/surefoot_fuzz_" + std::to_string(::getpid()) + extension),
          handle_(::open(path_.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0600)) {
        must(handle_ >= 0);
    }
    File(const File&) = delete;
    File& operator=(const File&) = delete;
    ~File() {
        ::close(handle_);
        ::unlink(path_.c_str());
    }
    const std::string& write(std::string_view bytes) {
        must(::ftruncate(handle_, 0) == 0);
        must(::pwrite(handle_, bytes.data(), bytes.size(), 0) ==
             static_cast<ssize_t>(bytes.size()));
        return path_;
    }

  private:
    std::string path_;
    int handle_;
};

File& file_of(std::uint8_t choice) {
    static File files[] = {
        File(".ply"), File(".pcd"), File(".las"), File(".vtk"), File(".txt"), File(".pts")};
    return files[choice % std::size(files)];
}

/// Reads all points block by block. Returns false on an error.
bool read_blocks(io::CloudStream& stream, std::vector<Eigen::Vector3d>& points_m) {
    points_m.clear();
    const Status status = stream.each_block([&](const io::PointCloud& block) -> Status {
        must(!block.problem());
        points_m.insert(points_m.end(), block.points_m.begin(), block.points_m.end());
        return {};
    });
    must_explain(status);
    return status.ok();
}

bool is_same(const Eigen::Vector3d& a_m, const Eigen::Vector3d& b_m) {
    for (int axis = 0; axis < 3; ++axis)
        if (a_m[axis] != b_m[axis] && !(std::isnan(a_m[axis]) && std::isnan(b_m[axis])))
            return false;
    return true;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size == 0) return 0;
    const std::string_view bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
    const std::string& path = file_of(data[0]).write(bytes);
    const auto whole = io::read_cloud(path);
    must_explain(whole);
    auto stream = io::CloudStream::open(path);
    must_explain(stream);
    if (!stream) {
        must(!whole.ok());
        return 0;
    }
    std::vector<Eigen::Vector3d> points_m;
    const bool read = read_blocks(*stream, points_m);
    if (whole.ok()) {
        must(read && points_m.size() == whole->points_m.size());
        for (std::size_t i = 0; i < points_m.size(); ++i)
            must(is_same(points_m[i], whole->points_m[i]));
    }
    std::vector<Eigen::Vector3d> again_m;
    must(read_blocks(*stream, again_m) == read);
    if (read) must(again_m.size() == points_m.size());
    const auto shifted = io::read_shifted(path);
    must_explain(shifted);
    if (!shifted) return 0;
    must(shifted->shift_m.allFinite());
    for (const Eigen::Vector3f& p_m : shifted->points_m) must(p_m.allFinite());
    return 0;
}
