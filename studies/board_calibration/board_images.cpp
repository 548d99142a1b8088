// SPDX-License-Identifier: Apache-2.0
#include "studies/board_calibration/board_images.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "surefoot/io/file.hpp"
#include "surefoot/io/images/image_file.hpp"
#include "surefoot/io/recordings/recording.hpp"
#include "surefoot/io/recordings/video_frames.hpp"

namespace surefoot::app {
namespace {

using Use = std::function<void(BoardImages)>;

/// Image files of the same time. `right` is empty for one camera and for side-by-side images.
struct Entry {
    std::string name;
    std::string left;
    std::string right;
};

Result<std::vector<std::string>> images_in(const std::string& folder) {
    return io::list_files(folder, {".png", ".jpg", ".jpeg", ".pgm", ".ppm"});
}

bool begins_with(const std::string& name, const std::string& word) {
    return name.starts_with(word);
}

/// Pairs files of `left` and `right` whose names are equal after the word `left_word` or
/// `right_word`. Leaves files without a partner out and adds a note.
std::vector<Entry> paired(const std::string& left_folder,
                          const std::vector<std::string>& left,
                          const std::string& left_word,
                          const std::string& right_folder,
                          const std::vector<std::string>& right,
                          const std::string& right_word,
                          BoardSource& about) {
    std::vector<Entry> entries;
    for (const std::string& name : left) {
        const std::string partner = right_word + name.substr(left_word.size());
        if (std::find(right.begin(), right.end(), partner) == right.end()) {
            about.notes.push_back(
                fmt::format("{} has no partner {} and is left out.", name, partner));
            continue;
        }
        entries.push_back(
            {name, io::join_path(left_folder, name), io::join_path(right_folder, partner)});
    }
    const auto alone = std::ssize(right) - std::ssize(entries);
    if (alone > 0)
        about.notes.push_back(
            fmt::format("{} right images have no partner and are left out.", alone));
    return entries;
}

/// Returns the folders of the left and right images inside `folder`; nullopt if there are none.
std::optional<std::pair<std::string, std::string>> camera_folders(const std::string& folder) {
    constexpr const char* kPairs[][2] = {
        {"left", "right"}, {"cam0/data", "cam1/data"}, {"cam0", "cam1"}, {"image_0", "image_1"}};
    for (const auto& names : kPairs) {
        const std::string left = io::join_path(folder, names[0]);
        const std::string right = io::join_path(folder, names[1]);
        if (io::is_folder(left) && io::is_folder(right)) return std::pair{left, right};
    }
    return std::nullopt;
}

Result<std::vector<Entry>> stereo_entries(const std::string& folder, BoardSource& about) {
    if (const auto cameras = camera_folders(folder)) {
        const auto left = images_in(cameras->first);
        if (!left) return left.error();
        const auto right = images_in(cameras->second);
        if (!right) return right.error();
        return paired(cameras->first, *left, "", cameras->second, *right, "", about);
    }
    const auto names = images_in(folder);
    if (!names) return names.error();
    std::vector<std::string> left;
    std::vector<std::string> right;
    for (const std::string& name : *names) {
        if (begins_with(name, "left")) left.push_back(name);
        if (begins_with(name, "right")) right.push_back(name);
    }
    if (!left.empty() && !right.empty())
        return paired(folder, left, "left", folder, right, "right", about);
    std::vector<Entry> entries;
    for (const std::string& name : *names)
        entries.push_back({name, io::join_path(folder, name), {}});
    return entries;
}

Result<std::vector<Entry>> mono_entries(const std::string& folder, const std::string& camera) {
    const auto names = images_in(folder);
    if (!names) return names.error();
    const auto any = [&](const char* word) {
        return std::any_of(names->begin(), names->end(), [&](const std::string& name) {
            return begins_with(name, word);
        });
    };
    const bool two_cameras = any("left") && any("right");
    if (two_cameras && camera.empty()) {
        return usage_error(
            fmt::format("{}: the folder has images of two cameras (left*, right*); use calibrate "
                        "stereo for both, or --camera left or --camera right for one of them",
                        folder));
    }
    std::vector<Entry> entries;
    for (const std::string& name : *names) {
        if (two_cameras && !begins_with(name, camera)) continue;
        entries.push_back({name, io::join_path(folder, name), {}});
    }
    return entries;
}

/// Splits a side-by-side image into left and right.
Status split(BoardImages& images) {
    const GreyImage both = std::move(images.left);
    if (both.width() < 2 || both.width() % 2 != 0) {
        return input_error(
            fmt::format("{}: the image is {} px wide; side-by-side images of two equal cameras "
                        "need an even width",
                        images.name,
                        both.width()));
    }
    const int width = both.width() / 2;
    images.left = GreyImage(width, both.height());
    images.right = GreyImage(width, both.height());
    for (int v = 0; v < both.height(); ++v) {
        std::copy(both.row(v), both.row(v) + width, images.left.row(v));
        std::copy(both.row(v) + width, both.row(v) + 2 * width, images.right.row(v));
    }
    return {};
}

Status load(const Entry& entry, bool stereo, BoardImages& images) {
    images.name = entry.name;
    auto left = io::read_grey_image(entry.left);
    if (!left) return left.error();
    images.left = std::move(*left);
    if (!stereo) return {};
    if (entry.right.empty()) return split(images);
    auto right = io::read_grey_image(entry.right);
    if (!right) return right.error();
    images.right = std::move(*right);
    return {};
}

Status for_video(const std::string& path, bool stereo, const Use& use, BoardSource& about) {
    auto video = io::VideoFrames::open(path);
    if (!video) return video.error();
    const int step = std::max(1, video->count() / kMostVideoViews);
    for (int index = 0;; ++index) {
        auto frame = video->next();
        if (!frame && index == 0) return frame.error();
        if (!frame) about.notes.push_back(frame.error().message + ".");
        if (!frame || !frame->has_value()) return {};
        if (index % step != 0) continue;
        BoardImages images{fmt::format("frame {}", index), std::move((*frame)->image), {}};
        if (stereo) {
            if (Status status = split(images); !status) return status;
        }
        use(std::move(images));
    }
}

}  // namespace

Result<BoardSource> for_board_images(const std::string& source,
                                     bool stereo,
                                     const std::string& camera,
                                     const Use& use) {
    BoardSource about;
    if (io::is_file(source) && io::is_video_name(source)) {
        if (const Status status = for_video(source, stereo, use, about); !status)
            return status.error();
        return about;
    }
    const auto entries = stereo ? stereo_entries(source, about) : mono_entries(source, camera);
    if (!entries) return entries.error();
    if (entries->empty()) {
        return input_error(fmt::format(
            "{}: the source has no images of a board; give {} (.png .jpg .pgm .ppm) or a video",
            source,
            stereo ? "images left* and right*, folders left and right, or side-by-side images"
                   : "images"));
    }
    for (const Entry& entry : *entries) {
        BoardImages images;
        if (const Status status = load(entry, stereo, images); !status) return status.error();
        use(std::move(images));
    }
    return about;
}

}  // namespace surefoot::app
