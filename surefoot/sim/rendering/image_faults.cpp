// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/rendering/image_faults.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "surefoot/core/rng.hpp"

namespace surefoot::sim {
namespace {

constexpr int kMaxFreezeFrames = 100'000;

/// Faults indexed by frame; no value for a frame without a fault.
using Schedule = std::vector<std::optional<InjectedFault>>;

void draw(const ImageFaultConfig& config, int height, Rng& rng, Schedule& schedule) {
    const int frames = static_cast<int>(schedule.size());
    int thaw_frame = 0;
    for (int frame = 1; frame < frames; ++frame) {
        // Always draw two numbers per frame, so that a fault of one frame does not change the
        // random numbers of later frames.
        double chance = rng.uniform();
        const int tear_row = 1 + static_cast<int>(rng.uniform() * std::max(height - 1, 1));
        const auto happens = [&](double probability) {
            chance -= probability;
            return chance < 0.0;
        };
        auto& slot = schedule[static_cast<std::size_t>(frame)];
        if (frame < thaw_frame) {
            slot = InjectedFault{frame, ImageFault::frozen, 0};
        } else if (happens(config.freeze_probability)) {
            slot = InjectedFault{frame, ImageFault::frozen, 0};
            thaw_frame = frame + config.freeze_frames;
        } else if (happens(config.drop_probability)) {
            slot = InjectedFault{frame, ImageFault::dropped, 0};
        } else if (happens(config.repeat_probability)) {
            slot = InjectedFault{frame, ImageFault::repeated, 0};
        } else if (happens(config.tear_probability)) {
            slot = InjectedFault{frame, ImageFault::torn, tear_row};
        }
    }
}

}  // namespace

void ImageFaultConfig::describe(ConfigVisitor& visitor) {
    visitor.number("drop_probability",
                   drop_probability,
                   0.0,
                   1.0,
                   "probability per frame that the frame never arrives");
    visitor.number("repeat_probability",
                   repeat_probability,
                   0.0,
                   1.0,
                   "probability per frame that the previous images arrive again");
    visitor.number("tear_probability",
                   tear_probability,
                   0.0,
                   1.0,
                   "probability per frame that the lower rows come from the previous frame");
    visitor.number("freeze_probability",
                   freeze_probability,
                   0.0,
                   1.0,
                   "probability per frame that the images stop changing for freeze_frames frames");
    visitor.integer(
        "freeze_frames", freeze_frames, 1, kMaxFreezeFrames, "number of frames in one freeze");
}

std::optional<std::string> ImageFaultConfig::problem(int frames, int height) const {
    for (const InjectedFault& fault : planned) {
        if (fault.frame < 1 || fault.frame >= frames) {
            return fmt::format(
                "a fault is planned for frame {}; give a frame from 1 to {}, because frame 0 has "
                "no older frame",
                fault.frame,
                frames - 1);
        }
        if (fault.tear_row < 0 || fault.tear_row >= height) {
            return fmt::format(
                "frame {} is to be torn at row {}; give a row from 1 to {}, or 0 for a random row",
                fault.frame,
                fault.tear_row,
                height - 1);
        }
    }
    return std::nullopt;
}

std::vector<InjectedFault> plan_faults(const ImageFaultConfig& config,
                                       int frames,
                                       int height,
                                       std::uint64_t seed) {
    Schedule schedule(static_cast<std::size_t>(std::max(frames, 0)));
    Rng rng(seed);
    draw(config, height, rng, schedule);
    for (InjectedFault fault : config.planned) {
        if (fault.kind == ImageFault::torn && fault.tear_row == 0) {
            fault.tear_row = 1 + static_cast<int>(rng.uniform() * std::max(height - 1, 1));
        }
        schedule[static_cast<std::size_t>(fault.frame)] = fault;
    }
    std::vector<InjectedFault> faults;
    for (const auto& fault : schedule) {
        if (fault) faults.push_back(*fault);
    }
    return faults;
}

}  // namespace surefoot::sim
