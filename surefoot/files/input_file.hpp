// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "surefoot/core/result.hpp"

/// Checks the kind and size of a user's file, and opens it for reading.
namespace surefoot::files {

/// Largest size of a file per format [bytes]. A file that states a larger size is not read.
namespace limits {
inline constexpr std::uint64_t kKeyBytes = 4096;              ///< tokens
inline constexpr std::uint64_t kSettingsBytes = 4ULL << 20U;  ///< settings, rigs, machines, scenes
inline constexpr std::uint64_t kTextBytes = 512ULL << 20U;    ///< lists, trajectories, IMU, reports
inline constexpr std::uint64_t kImageBytes = 512ULL << 20U;   ///< images: PNG, JPEG, PGM, PPM, PFM
inline constexpr std::uint64_t kMapBytes = 2ULL << 30U;       ///< grids, regions, place databases
inline constexpr std::uint64_t kCloudBytes = 4ULL << 30U;     ///< clouds that are read whole
inline constexpr std::uint64_t kStreamBytes = 1ULL << 42U;    ///< videos and clouds read in pieces
}  // namespace limits

/// Kinds of file that a path may name.
enum class Accept : std::uint8_t {
    regular,          ///< a regular file, also through links
    regular_or_fifo,  ///< also a FIFO; `read` then reports `would_wait` and does not block
};

/// Returns an error unless `path` can be opened for reading, is of an accepted kind, and has at
/// most `max_bytes`. For readers that open the file themselves by its name (videos).
[[nodiscard]] Status check_input(const std::string& path,
                                 std::uint64_t max_bytes,
                                 Accept accept = Accept::regular);

/// A file that is open for reading. Opening never blocks. Use it from one thread at a time.
class InputFile {
  public:
    /// Errors (ErrorCode::input) name the path. They also name the kind if it is not accepted, or
    /// the size and the limit if the file is too large.
    [[nodiscard]] static Result<InputFile> open(const std::string& path,
                                                std::uint64_t max_bytes,
                                                Accept accept = Accept::regular);
    ~InputFile();
    InputFile(InputFile&& other) noexcept;
    InputFile& operator=(InputFile&& other) noexcept;

    /// Returns the size when opened [bytes]; 0 for a FIFO and for files of the kernel.
    [[nodiscard]] std::uint64_t size() const noexcept { return size_; }
    [[nodiscard]] const std::string& path() const noexcept { return path_; }

    struct Piece {
        std::size_t bytes = 0;    ///< bytes read into the buffer
        bool would_wait = false;  ///< true: the FIFO has no data now
    };
    /// Reads the next bytes. 0 bytes without `would_wait` mean the end of the file.
    [[nodiscard]] Result<Piece> read(std::span<char> buffer);
    /// Reads `count` bytes from `offset`, or fewer if the opened file ends before. Returns an error
    /// if the file became shorter.
    [[nodiscard]] Result<std::string> read_at(std::uint64_t offset, std::uint64_t count);

  private:
    InputFile(std::string path, int descriptor, std::uint64_t size)
        : path_(std::move(path)), descriptor_(descriptor), size_(size) {}
    std::string path_;
    int descriptor_ = -1;
    std::uint64_t size_ = 0;
};

/// Reads a whole regular file.
[[nodiscard]] Result<std::string> read_file(const std::string& path,
                                            std::uint64_t max_bytes = limits::kTextBytes);

}  // namespace surefoot::files
