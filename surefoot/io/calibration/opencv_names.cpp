// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/calibration/opencv_names.hpp"

#include <cctype>
#include <initializer_list>
#include <vector>

namespace surefoot::io {
namespace {

/// Returns the letters and digits of a key in lower case.
std::string plain(const std::string& key) {
    std::string out;
    for (const char c : key) {
        const auto byte = static_cast<unsigned char>(c);
        if (std::isalnum(byte) != 0) out += static_cast<char>(std::tolower(byte));
    }
    return out;
}

struct Entry {
    std::string plain_key;
    NamedNode named;
};

/// Returns the keys of the document and of its groups. A matrix {rows, cols, data} is not a group.
std::vector<Entry> entries_of(const YamlNode& root) {
    std::vector<Entry> entries;
    for (const YamlNode& item : root.items) {
        entries.push_back({plain(item.key), {&item, item.key}});
        if (!item.is_mapping() || item.find("data") != nullptr) continue;
        for (const YamlNode& inner : item.items) {
            const std::string key = item.key + "." + inner.key;
            entries.push_back({plain(key), {&inner, key}});
        }
    }
    return entries;
}

NamedNode find_name(const std::vector<Entry>& entries, const std::string& name) {
    for (const Entry& entry : entries) {
        if (entry.plain_key == name) return entry.named;
    }
    return {};
}

NamedNode find_first(const std::vector<Entry>& entries, std::initializer_list<const char*> names) {
    for (const char* name : names) {
        if (NamedNode found = find_name(entries, name); found.node != nullptr) return found;
    }
    return {};
}

/// The parts of key names that mark the left and the right camera.
struct Sides {
    const char* left;
    const char* right;
    bool numbered;
};
constexpr Sides kSides[] = {{"1", "2", true},
                            {"left", "right", false},
                            {"l", "r", false},
                            {"0", "1", true},
                            {"cam1", "cam2", true},
                            {"camera1", "camera2", true},
                            {"cam0", "cam1", true},
                            {"camera0", "camera1", true},
                            {"camleft", "camright", false},
                            {"cameraleft", "cameraright", false},
                            {"leftcam", "rightcam", false},
                            {"leftcamera", "rightcamera", false},
                            {"caml", "camr", false}};

struct Pair {
    NamedNode left, right;
    const Sides* sides = nullptr;
};

bool is_matrix(const NamedNode& named) {
    return named.node != nullptr && !named.node->is_scalar() &&
           named.node->kind != YamlNode::Kind::null;
}

/// Finds a matrix with the camera mark after or before its name: "K1" or "1K".
NamedNode find_sided(const std::vector<Entry>& entries, const std::string& base, const char* side) {
    NamedNode found = find_name(entries, base + side);
    if (!is_matrix(found)) found = find_name(entries, side + base);
    return is_matrix(found) ? found : NamedNode{};
}

/// Finds the first naming scheme that has the matrix of both cameras. If there is none, finds the
/// first scheme that has the matrix of one camera.
Pair find_pair(const std::vector<Entry>& entries,
               std::initializer_list<const char*> bases,
               const Sides* wanted) {
    Pair half;
    for (const Sides& sides : kSides) {
        // Numbering must be consistent: D1 beside K0 and K1 belongs to the right camera.
        if (wanted != nullptr && wanted->numbered && sides.numbered && wanted != &sides) continue;
        for (const char* base : bases) {
            Pair pair{find_sided(entries, base, sides.left),
                      find_sided(entries, base, sides.right),
                      &sides};
            const bool left = pair.left.node != nullptr;
            const bool right = pair.right.node != nullptr;
            if (left && right) return pair;
            if ((left || right) && half.sides == nullptr) half = pair;
        }
    }
    return half;
}

}  // namespace

OpenCvNames find_opencv_names(const YamlNode& root) {
    const std::vector<Entry> entries = entries_of(root);
    const Pair matrix = find_pair(entries,
                                  {"m",
                                   "k",
                                   "cameramatrix",
                                   "cameramat",
                                   "cammatrix",
                                   "cammat",
                                   "mtx",
                                   "cm",
                                   "intrinsicmatrix",
                                   "intrinsicsmatrix",
                                   "intrinsics",
                                   "intrinsic",
                                   "matrix"},
                                  nullptr);
    const Pair distortion = find_pair(entries,
                                      {"d",
                                       "distcoeffs",
                                       "distcoeff",
                                       "distcoefs",
                                       "distcoef",
                                       "distcoefficients",
                                       "distortioncoefficients",
                                       "distortioncoeffs",
                                       "distortioncoeff",
                                       "distortion",
                                       "distortions",
                                       "dist"},
                                      matrix.sides);
    OpenCvNames names;
    names.left_matrix = matrix.left;
    names.right_matrix = matrix.right;
    names.left_distortion = distortion.left;
    names.right_distortion = distortion.right;
    names.R = find_first(entries,
                         {"r",
                          "rotation",
                          "rotationmatrix",
                          "rstereo",
                          "stereor",
                          "rot",
                          "rotmatrix",
                          "rotmat",
                          "rmat",
                          "rvec",
                          "om",
                          "extrinsicsr",
                          "extrinsicr"});
    names.T = find_first(entries,
                         {"t",
                          "translation",
                          "translationvector",
                          "translationmatrix",
                          "tstereo",
                          "stereot",
                          "trans",
                          "transvec",
                          "tvec",
                          "extrinsicst",
                          "extrinsict"});
    names.width = find_first(entries, {"imagewidth", "imgwidth", "width"});
    names.height = find_first(entries, {"imageheight", "imgheight", "height"});
    names.size = find_first(entries, {"imagesize", "imgsize", "size", "resolution"});
    return names;
}

}  // namespace surefoot::io
