// SPDX-License-Identifier: Apache-2.0
// Is our matcher better than OpenCV's matchers if each gets the same tuning budget? For each
// matcher one of 36 settings is chosen on two Middlebury pairs and on simulated images. The scores
// come from the other Middlebury pairs, from new simulated images, and from images that are
// difficult for cameras.
// Usage: matcher_tuning STEREO_DATA_DIR OUT_DIR FIRST_SEED [FIRST_TUNING_SEED]
//   FIRST_SEED: first seed of the images for the scores. FIRST_TUNING_SEED: first
//   seed of the images for the choice, default 21.
//
// Writes into OUT_DIR:
//   chosen.csv    matcher,set,words,loss,loss_as_it_comes: the setting with the smallest loss.
//                 Loss: mean of bad_1 + 2 bad_2 over the pairs, plus this mean over the simulated
//                 images. Sets: "chosen" uses both means; "for pairs" and "for simulated" use one
//                 mean alone.
//   held_out.csv  kind,truth,image,matcher,set,bad_1,bad_2,matched_bad_1,matched_bad_2,density [%]
//                 kinds: "tuned on", "pair", "simulated", and one per difficult condition. Sets:
//                 those above, and "as it comes" for the default settings of our whole matcher.
#include <fmt/format.h>
#include <fmt/os.h>

#include <array>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "lab/stereo_pairs/rival_matchers.hpp"
#include "lab/stereo_pairs/stereo_pairs.hpp"
#include "service/console/log.hpp"
#include "surefoot/io/settings/config_yaml.hpp"

namespace surefoot::experiments {
namespace {

struct Images {
    std::string kind;
    std::vector<TruePair> pairs;
};

/// Scenes that the fitted ZED sees with additional settings. Each scene has its own seed.
struct Series {
    const char* kind;
    std::vector<std::string> scenes;
    std::vector<std::string> settings;
};

std::vector<Series> held_out_series() {
    const std::vector<std::string> usual = {
        "demo_stairs", "sill_13", "kerb_down_150", "stairs_up_ada"};
    return {
        {"simulated", {std::begin(kScenes), std::end(kScenes)}, {}},
        {"smear", usual, {"optics.smear_sigma_px=2"}},
        {"finger mark", usual, {"optics.smudge_sigma_px=4"}},
        {"glass", {"glass_door", "glass_wall", "glass_passage", "glass_table"}, {}},
        {"sun", {"stripes_window", "stripes_glaring", "stripes_fence", "shadow_railing"}, {}},
        {"sun and over-exposed",
         usual,
         {"exposure.sun_warm_up=true", "exposure.warm_up_factor=2.5"}},
        {"right camera brighter", usual, {"exposure.right_gain=1.3"}},
        {"right camera darker", usual, {"exposure.right_gain=0.6"}},
    };
}

/// Renders the scenes of a series. Only pixels that both cameras see keep their truth.
Result<Images> render(const Series& series, std::uint64_t first_seed) {
    Images images{series.kind, {}};
    images.pairs.reserve(series.scenes.size());
    sim::SceneOptions options;
    options.profile = sim::CameraProfile::zed;
    for (const std::string& setting : series.settings) {
        if (auto set = io::override_config(setting, io::describe_config(options)); !set)
            return set.error();
    }
    options.seed = first_seed;
    for (const std::string& scene : series.scenes) {
        options.scene = scene;
        auto pair = simulated_pair(options);
        if (!pair) return pair.error();
        forget_hidden(*pair);
        pair->name = scene;
        images.pairs.push_back(std::move(*pair));
        ++options.seed;
    }
    return images;
}

/// Splits the pairs: cones and cloth3 are for tuning, the other pairs for the scores.
std::vector<Images> halves(std::vector<TruePair> pairs) {
    Images tuned{"tuned on", {}};
    Images kept{"pair", {}};
    for (TruePair& pair : pairs) {
        const bool tunes = pair.name == "cones" || pair.name == "cloth3";
        (tunes ? tuned : kept).pairs.push_back(std::move(pair));
    }
    return {tuned, kept};
}

double mean_loss(const Match& match, const std::vector<TruePair>& pairs) {
    double sum = 0.0;
    for (const TruePair& pair : pairs) {
        const Score s = score(pair, match(pair), Truth::as_published);
        sum += s.bad_1 + 2.0 * s.bad_2;
    }
    return sum / static_cast<double>(pairs.size());
}

struct Loss {
    double pairs = 0.0;
    double simulated = 0.0;
};

/// Criterion for the choice of a setting. It weights both kinds of tuning images, or uses one kind
/// alone.
struct Aim {
    const char* set;
    double pairs;
    double simulated;
    const char* kind;  ///< kind of the images that show the result; nullptr = all
    [[nodiscard]] bool judges(const std::string& images) const {
        return kind == nullptr || images == kind;
    }
    [[nodiscard]] double of(const Loss& loss) const {
        return pairs * loss.pairs + simulated * loss.simulated;
    }
};
constexpr Aim kAims[] = {{"chosen", 1.0, 1.0, nullptr},
                         {"for pairs", 1.0, 0.0, "pair"},
                         {"for simulated", 0.0, 1.0, "simulated"}};

/// Chooses the best setting of a matcher for each aim and computes its loss.
class Choice {
  public:
    Choice(const Candidate& candidate,
           const std::vector<TruePair>& pairs,
           const std::vector<TruePair>& simulated) {
        const auto loss = [&](const Match& match) {
            return Loss{mean_loss(match, pairs), mean_loss(match, simulated)};
        };
        as_it_comes_ = loss(candidate.as_it_comes);
        for (const Setting& setting : candidate.settings) {
            const Loss found = loss(setting.match);
            for (std::size_t k = 0; k < std::size(kAims); ++k) {
                if (best_[k] != nullptr && kAims[k].of(found) >= kAims[k].of(losses_[k])) continue;
                best_[k] = &setting;
                losses_[k] = found;
            }
        }
    }
    [[nodiscard]] const Setting& best(std::size_t aim) const { return *best_[aim]; }
    void print(fmt::ostream& out, const std::string& matcher) const {
        for (std::size_t k = 0; k < std::size(kAims); ++k)
            out.print("{},{},{},{:.3f},{:.3f}\n",
                      matcher,
                      kAims[k].set,
                      best_[k]->words,
                      kAims[k].of(losses_[k]),
                      kAims[k].of(as_it_comes_));
    }

  private:
    std::array<const Setting*, std::size(kAims)> best_{};
    std::array<Loss, std::size(kAims)> losses_{};
    Loss as_it_comes_;
};

void report(fmt::ostream& out,
            const Images& images,
            const std::string& matcher,
            const char* set,
            const Match& match) {
    for (const TruePair& pair : images.pairs) {
        const Image<float> disparity_px = match(pair);
        for (const Truth truth : {Truth::as_published, Truth::centred}) {
            const Score s = score(pair, disparity_px, truth);
            out.print("{},{},{},{},{},{:.3f},{:.3f},{:.3f},{:.3f},{:.2f}\n",
                      images.kind,
                      kTruthNames[static_cast<std::size_t>(truth)],
                      pair.name,
                      matcher,
                      set,
                      s.bad_1,
                      s.bad_2,
                      s.matched_bad_1,
                      s.matched_bad_2,
                      s.density);
        }
    }
}

/// Renders all series. The seeds continue from one series to the next.
Status add_series(const std::vector<Series>& all, std::uint64_t seed, std::vector<Images>& out) {
    for (const Series& series : all) {
        auto images = render(series, seed);
        if (!images) return images.error();
        out.push_back(std::move(*images));
        seed += series.scenes.size();
    }
    return {};
}

/// `our_whole` rebuilds the matcher of the pipeline, so that its penalties can be set. Checks that
/// both matchers give the same disparities.
bool is_the_chain(const TruePair& pair) {
    const Image<float> built_px = our_whole({})(pair);
    const Image<float> chain_px = chain()(pair);
    return built_px.size() == chain_px.size() &&
           std::memcmp(built_px.data(), chain_px.data(), built_px.size() * sizeof(float)) == 0;
}

Status run(const std::string& data,
           const std::string& folder,
           std::uint64_t first_seed,
           std::uint64_t first_tuning_seed) {
    auto pairs = middlebury_pairs(data);
    if (!pairs) return pairs.error();
    std::vector<Images> sets = halves(std::move(*pairs));
    const std::vector<TruePair> real = sets.front().pairs;
    if (!is_the_chain(real.front()))
        return input_error(
            "our_whole no longer equals the pipeline's matcher; update "
            "lab/stereo_pairs/rival_matchers.cpp");
    const Series for_tuning{"tuned on", {"demo_stairs", "sill_13", "kerb_down_150", "floor"}, {}};
    if (auto added = add_series({for_tuning}, first_tuning_seed, sets); !added) return added;
    const std::vector<TruePair> simulated = sets.back().pairs;
    if (auto added = add_series(held_out_series(), first_seed, sets); !added) return added;
    auto choices = fmt::output_file(folder + "/chosen.csv");
    choices.print("matcher,set,words,loss,loss_as_it_comes\n");
    auto out = fmt::output_file(folder + "/held_out.csv");
    out.print("kind,truth,image,matcher,set,bad_1,bad_2,matched_bad_1,matched_bad_2,density\n");
    for (const Candidate& candidate : candidates()) {
        const Choice choice(candidate, real, simulated);
        choice.print(choices, candidate.name);
        fmt::print(stderr, "{}: {}\n", candidate.name, choice.best(0).words);
        for (std::size_t k = 0; k < std::size(kAims); ++k)
            for (const Images& images : sets)
                if (kAims[k].judges(images.kind))
                    report(out, images, candidate.name, kAims[k].set, choice.best(k).match);
    }
    for (const Images& images : sets)
        report(out, images, "our whole matcher", "as it comes", chain());
    return {};
}

}  // namespace
}  // namespace surefoot::experiments

// An uncaught exception ends the experiment and prints its message. This is intended.
int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape)
    using namespace surefoot;
    if (argc < 4) {
        fmt::print(
            stderr,
            "usage: matcher_tuning STEREO_DATA_DIR OUT_DIR FIRST_SEED [FIRST_TUNING_SEED]\n");
        return 2;
    }
    cv::setNumThreads(1);
    const auto seed = [&](int i) { return std::strtoull(argv[i], nullptr, 10); };
    const auto done = experiments::run(argv[1], argv[2], seed(3), argc > 4 ? seed(4) : 21);
    return done ? 0 : app::report(done.error());
}
