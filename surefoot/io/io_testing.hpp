// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

#include "surefoot/core/rng.hpp"

/// Test helpers of io: a temporary folder, the data folder, and random damage to files.
namespace surefoot::io::testing {

/// A temporary folder for one test; the destructor removes it.
class TemporaryFolder {
  public:
    TemporaryFolder() {
        std::string name = (std::filesystem::temp_directory_path() / "surefoot_io_XXXXXX").string();
        path_ = ::mkdtemp(name.data()) != nullptr ? name : std::string();
    }
    ~TemporaryFolder() {
        std::error_code ignored;
        if (!path_.empty()) std::filesystem::remove_all(path_, ignored);
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;

    [[nodiscard]] const std::string& path() const { return path_; }
    [[nodiscard]] std::string operator/(const std::string& name) const {
        return path_ + "/" + name;
    }

  private:
    std::string path_;
};

/// Path of a data file or folder. If it is missing: an empty string, and a printed line says so.
inline std::string data_path(const std::string& name) {
    const char* folder = std::getenv("SUREFOOT_DATA_DIR");
    const std::string path =
        std::string(folder != nullptr ? folder : SUREFOOT_DEFAULT_DATA_DIR) + "/" + name;
    if (std::filesystem::exists(path)) return path;
    static int skipped = 0;
    std::printf(
        "data %s is not there: %d checks of this program skipped\n", name.c_str(), ++skipped);
    return {};
}

/// Applies one random damage: flipped bit, changed byte, hole, repeated piece, cut, or huge number.
inline std::string mutated(std::string bytes, Rng& rng) {
    const auto position = [&] { return static_cast<std::size_t>(rng.below(bytes.size() + 1)); };
    const std::uint64_t damages = 1 + rng.below(3);
    for (std::uint64_t i = 0; i < damages && !bytes.empty(); ++i) {
        const std::size_t at = std::min(position(), bytes.size() - 1);
        const std::size_t length = static_cast<std::size_t>(rng.below(16)) + 1;
        static constexpr const char* kPieces[] = {"99999999999",
                                                  "-1",
                                                  "nan",
                                                  "inf",
                                                  "1e999",
                                                  "0",
                                                  "4294967295",
                                                  ":",
                                                  "[",
                                                  "]",
                                                  "\n",
                                                  " "};
        switch (rng.below(7)) {
            case 0: bytes[at] = static_cast<char>(bytes[at] ^ (1 << rng.below(8))); break;
            case 1: bytes[at] = static_cast<char>(rng.below(256)); break;
            case 2: bytes.erase(at, length); break;
            case 3: bytes.insert(at, bytes.substr(at, length)); break;
            case 4: bytes.resize(at); break;
            case 5: bytes.insert(at, kPieces[rng.below(std::size(kPieces))]); break;
            default:
                bytes.replace(at,
                              std::min(length, bytes.size() - at),
                              kPieces[rng.below(std::size(kPieces))]);
                break;
        }
    }
    return bytes;
}

/// Passes `count` damaged versions of a valid file to a parser, which must survive all of them.
inline void for_each_mutation(const std::string& valid,
                              int count,
                              std::uint64_t seed,
                              const std::function<void(const std::string&)>& parse) {
    Rng rng(seed);
    for (int i = 0; i < count; ++i) parse(mutated(valid, rng));
}

inline bool contains(std::string_view text, std::string_view part) {
    return text.find(part) != text.npos;
}

}  // namespace surefoot::io::testing
