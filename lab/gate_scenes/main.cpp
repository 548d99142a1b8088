// SPDX-License-Identifier: Apache-2.0
// Which hazards does the gate miss, and which safe movements does it refuse?
// Usage: gate_scenes TIER SCRATCH FIRST_SEED SCENES [KINDS [FROM]]
//   gate_scenes maps out/scenes 73001 30000
// TIER: maps    true heights with the error distribution of maps of whole runs (map_noise.hpp):
//               without errors, at the measured noise, at twice that noise, and overconfident
//               (errors as measured, but the smallest sigma stated everywhere)
//       depth   map of a run with analytic depth and true poses
//       images  map of a run of the whole pipeline with images of the fitted ZED profile
//       large   the same with images of 1280 x 720 px, so the ground in front is matched finely
//       curve   as maps, with the noise and single limits of the gate scaled
//       drift   as maps; the machine stands off its believed position by the stated drift
// SCRATCH       folder for results and temporary files
// SCENES        number of scenes with a hazard per kind. The number of safe scenes per kind is a
//               tenth of it for maps, a fifth for depth, images and large, and equal for curve and
//               drift.
// KINDS         kinds of hazards with commas between them (kHazardNames); default: all
// FROM          number of the first scene; default 0
//
// gate_scenes again SCRATCH KIND SCENE_SEED: repeats one hazard of `maps`, by the seed in its line.
// Prints the gate's answers and writes SCRATCH/again.csv with the cells of each map.
//
// Each scene has one movement. The oracle (sim::judge) must rate it as clearly dangerous in a scene
// with a hazard, and as clearly safe in a safe scene; otherwise the scene is drawn again. In every
// hundredth scene the gate is also asked for all 26 movements. The tiers depth, images and large
// are called runs below; there this happens in every scene.
//
// Results are files in SCRATCH/TIER, one set per chunk of scenes. A file is written completely or
// not at all, so that the same command continues an interrupted campaign.
//   KIND_SEED_FROM.csv  kind,variant,what,count
//     what: hazards, missed (dangerous but OK), hazards_unknown (refused only because of unknown
//     ground), safe, refused, safe_unknown (as hazards_unknown), thesis_missed and thesis_refused
//     (by the limits of the reference thesis, Lange 2016). all_...: the same for all movements, but
//     not for the thesis.
//     reason:NAME and proof:NAME (a proof that does not hold) of refused safe movements;
//     alone:NAME: a reason without other reasons; danger:NAME: the first danger of each hazard.
//     Safe movements in scenes with a hazard: beside_safe (all), beside_refused, and beside:NAME
//     (primary reason of a refusal).
//     The variant "scenes" counts scenes: drawn_hazards and drawn_safe (with the repeated draws),
//     never_clear_hazards and never_clear_safe (no draw was clearly dangerous or clearly safe, as
//     wanted). Runs instead: kept, not_clear_any_more (at the pose where the run ended), no_map.
//   KIND_SEED_FROM.misses.csv   each hazard that the gate allowed: parameters to repeat the scene,
//     the movement, the oracle's result
//   KIND_SEED_FROM.refused.txt  runs only: the gate's answer, if it refused the safe movement of a
//     scene
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <initializer_list>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lab/scenes/hazard_scene.hpp"
#include "lab/scenes/map_noise.hpp"
#include "lab/scenes/scene_chain.hpp"
#include "lab/scenes/scene_sight.hpp"
#include "service/console/log.hpp"
#include "service/console/source.hpp"
#include "studies/lange2016/thesis_policy_steps.hpp"
#include "studies/runs/offline_map.hpp"
#include "surefoot/camera/rectifier.hpp"
#include "surefoot/gate/gate.hpp"
#include "surefoot/gate/verdict_text.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/io/text.hpp"
#include "surefoot/perception/settings.hpp"
#include "surefoot/sim/safety_oracle/safety_oracle.hpp"
#include "surefoot/sim/sensors/rigs.hpp"
#include "surefoot/traversability/traversability.hpp"

namespace surefoot::experiments {
namespace {

constexpr int kMostDraws = 40;
constexpr int kAllEvery = 100;
constexpr int kSafeEvery = 10;       ///< a safe scene for every n-th index in the tier maps
constexpr int kSafeEveryOfRuns = 5;  ///< stride for runs, which take seconds

/// A machine whose gate is queried, and the errors of the map that this gate reads.
struct Variant {
    std::string name;
    Machine machine;
    int map = 0;  ///< variants with the same map number share one map
    std::optional<MapNoise> noise = std::nullopt;  ///< nullopt = a map without errors
    double shift_m = 0.0;  ///< sigma of the error of the believed position, per axis [m]
};

/// A scene with a movement that is clearly dangerous or clearly safe.
struct Question {
    HazardScene scene;
    sim::SafetyAnswer truth;
    int draws = 0;
    std::uint64_t scene_seed = 0;
};

bool can_stand(const sim::SafetyAnswer& truth) {
    return !truth.has(sim::Danger::no_stance) && !truth.has(sim::Danger::not_level_here);
}

/// Draws scene number `index` of a campaign. `draws` is 0 if no drawn scene was clear; the caller
/// must not use that scene.
Question draw(Hazard kind,
              bool relief_only,
              std::uint64_t seed,
              std::uint64_t index,
              const Machine& machine,
              Placing placing) {
    Question question;
    for (int k = 0; k < kMostDraws; ++k) {
        const auto stream =
            static_cast<std::uint64_t>(kind) * kMostDraws + static_cast<std::uint64_t>(k);
        question.scene_seed = mix_seed(mix_seed(seed, index), stream) >> 16U;
        question.scene =
            make_hazard_scene(kind, relief_only, question.scene_seed, machine, placing);
        question.truth = sim::judge(
            question.scene.scene(), machine, question.scene.T_world_body, question.scene.command);
        if (!question.truth.clear_cut || !can_stand(question.truth) ||
            question.truth.safe != relief_only)
            continue;
        question.draws = k + 1;
        break;
    }
    return question;
}

class Tally {
  public:
    void add(const std::string& variant, const std::string& what, int count = 1) {
        counts_[{variant, what}] += count;
    }
    [[nodiscard]] std::string csv(Hazard kind) const {
        std::string text = "kind,variant,what,count\n";
        for (const auto& [key, count] : counts_)
            text += fmt::format("{},{},{},{}\n",
                                kHazardNames[static_cast<int>(kind)],
                                key.first,
                                key.second,
                                count);
        return text;
    }
    std::string misses =
        "kind,thing,relief_only,seed,variant,command,relief_mm,x_m,y_m,yaw_rad,edge_x_m,edge_y_m,"
        "normal_x,normal_y,"
        "danger,value_m,limit_m,danger_x_m,danger_y_m,sentence\n";
    std::string refused;

  private:
    std::map<std::pair<std::string, std::string>, int> counts_;
};

/// Makes the query for `command` from the pose that the machine believes.
gate::Query query_of(int command, const Pose& T_odom_body) {
    const double yaw = yaw_rad(T_odom_body);
    return gate::make_query(static_cast<std::uint8_t>(command),
                            T_odom_body.translation_m.x(),
                            T_odom_body.translation_m.y(),
                            std::cos(yaw),
                            std::sin(yaw));
}

gate::Verdict ask(const Machine& machine,
                  const grid::MapSnapshot& map,
                  const Pose& T_odom_body,
                  int command) {
    gate::Query query = query_of(command, T_odom_body);
    std::vector<std::string> assumed;
    if (const auto area = app::attest_start(machine, query, map, -1.0, assumed))
        query.attested = *area;
    return app::decide_offline(machine, query, map);
}

bool only_unknown(const gate::Verdict& verdict) {
    gate::ReasonSet unknown(gate::Reason::unknown_cells);
    unknown.add(gate::Reason::outside_map);
    return (verdict.reasons.bits() & ~unknown.bits()) == 0;
}

std::string missed_line(const Question& question,
                        const std::string& variant,
                        int command,
                        const Pose& T_odom_body,
                        const sim::SafetyAnswer& truth) {
    const HazardScene& s = question.scene;
    const sim::Finding& f = truth.dangers.front();
    return fmt::format(
        "{},{},{},{},{},{},{:.1f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{},{:.4f},{:.4f}"
        ",{:.4f},{:.4f},\"{}\"\n",
        kHazardNames[static_cast<int>(s.asked)],
        kHazardNames[static_cast<int>(s.thing)],
        s.relief_only ? 1 : 0,
        question.scene_seed,
        variant,
        command,
        1e3 * s.relief_m,
        T_odom_body.translation_m.x(),
        T_odom_body.translation_m.y(),
        yaw_rad(T_odom_body),
        s.edge_m.x(),
        s.edge_m.y(),
        s.normal.x(),
        s.normal.y(),
        sim::to_string(f.danger),
        f.value,
        f.limit,
        f.where_m.x(),
        f.where_m.y(),
        truth.sentence());
}

void count_refusal(const gate::Verdict& verdict, const std::string& variant, Tally& tally) {
    const auto reasons = gate::names_of(verdict.reasons);
    for (const std::string_view reason : reasons)
        tally.add(variant, fmt::format("reason:{}", reason));
    if (reasons.size() == 1) tally.add(variant, fmt::format("alone:{}", reasons.front()));
    for (const std::string_view proof : gate::unproven_names(verdict.evidence))
        tally.add(variant, fmt::format("proof:{}", proof));
}

/// Counts the verdict on a safe movement in a scene with a hazard.
void count_beside(const gate::Verdict& verdict, const std::string& variant, Tally& tally) {
    tally.add(variant, "beside_safe");
    if (verdict.decision == gate::Decision::ok) return;
    tally.add(variant, "beside_refused");
    tally.add(variant, fmt::format("beside:{}", gate::to_string(verdict.primary)));
}

/// Counts one verdict against the truth. `prefix` is "" for the movement of the scene and "all_"
/// for all movements.
void count_verdict(const gate::Verdict& verdict,
                   bool truly_safe,
                   const std::string& variant,
                   const std::string& prefix,
                   Tally& tally) {
    const bool ok = verdict.decision == gate::Decision::ok;
    tally.add(variant, prefix + (truly_safe ? "safe" : "hazards"));
    if (!ok && only_unknown(verdict))
        tally.add(variant, prefix + (truly_safe ? "safe_unknown" : "hazards_unknown"));
    if (truly_safe && !ok) tally.add(variant, prefix + "refused");
    if (!truly_safe && ok) tally.add(variant, prefix + "missed");
    if (truly_safe && !ok && prefix.empty()) count_refusal(verdict, variant, tally);
}

/// A map and the data that the queries on this map need.
struct AskedMap {
    const grid::MapSnapshot& snapshot;
    grid::GridGeometry geometry;
    ImageView<const float> rating;
    Pose T_odom_body;
};

void ask_own(const Question& question, const AskedMap& map, const Variant& variant, Tally& tally) {
    const int command = question.scene.command;
    const gate::Verdict verdict = ask(variant.machine, map.snapshot, map.T_odom_body, command);
    count_verdict(verdict, question.truth.safe, variant.name, "", tally);
    if (!question.truth.safe) {
        tally.add(variant.name,
                  fmt::format("danger:{}", sim::to_string(question.truth.dangers.front().danger)));
        if (verdict.decision == gate::Decision::ok)
            tally.misses +=
                missed_line(question, variant.name, command, map.T_odom_body, question.truth);
    }
    if (question.truth.safe && verdict.decision != gate::Decision::ok)
        tally.refused += fmt::format(
            "{}: {}\n",
            question.scene_seed,
            gate::text_of(verdict, query_of(command, map.T_odom_body), variant.machine));
    const bool thesis =
        app::thesis_allows(variant.machine, map.geometry, map.rating, map.T_odom_body, command);
    if (thesis != question.truth.safe)
        tally.add(variant.name, question.truth.safe ? "thesis_refused" : "thesis_missed");
}

/// True safety of every movement from the pose of the machine; computed once per scene.
std::vector<sim::SafetyAnswer> all_truths(const sim::Scene& scene,
                                          const Machine& machine,
                                          const Pose& T_world_body) {
    std::vector<sim::SafetyAnswer> truths;
    for (int command = 1; command < Machine::kMovementCodes; ++command)
        truths.push_back(sim::judge(scene, machine, T_world_body, command));
    return truths;
}

void ask_all(const Question& question,
             const std::vector<sim::SafetyAnswer>& truths,
             const AskedMap& map,
             const Variant& variant,
             Tally& tally) {
    for (int command = 1; command < Machine::kMovementCodes; ++command) {
        const sim::SafetyAnswer& truth = truths[static_cast<std::size_t>(command - 1)];
        if (!truth.clear_cut || !can_stand(truth)) continue;
        const gate::Verdict verdict = ask(variant.machine, map.snapshot, map.T_odom_body, command);
        count_verdict(verdict, truth.safe, variant.name, "all_", tally);
        if (truth.safe && !question.scene.relief_only) count_beside(verdict, variant.name, tally);
        if (!truth.safe && verdict.decision == gate::Decision::ok)
            tally.misses +=
                missed_line(question, variant.name + "/all", command, map.T_odom_body, truth);
    }
}

MapNoise overconfident(MapNoise noise) {
    noise.overconfident = true;
    noise.outlier_share = 1e-4;
    noise.outlier_most_m = 0.060;
    return noise;
}

/// Returns the variants of the tier `maps`.
std::vector<Variant> map_variants(const Machine& machine) {
    return {{"noise 0", machine, 0},
            {"noise 1", machine, 1, MapNoise()},
            {"noise 2", machine, 2, doubled_image_noise()},
            {"overconfident", machine, 3, overconfident(MapNoise())}};
}

MadeMap map_of(const HazardScene& scene, const SceneCells& cells, const Variant& variant) {
    if (!variant.noise) return clean_map(cells);
    Rng rng(mix_seed(scene.seed, 1));
    return noisy_map(cells, *variant.noise, scene.way_m == 0.0, rng);
}

Pose believed_pose(const Question& question, double shift_m) {
    Pose pose = question.scene.T_world_body;
    Rng rng(mix_seed(question.scene_seed, 2));
    pose.translation_m.head<2>() += shift_m * Eigen::Vector2d(rng.normal(), rng.normal());
    return pose;
}

/// Returns the variants of the tier `drift`. The drifts are below the gate's limit for a cell (25
/// mm), and the map states them correctly.
std::vector<Variant> drift_variants(const Machine& machine) {
    std::vector<Variant> all;
    int map = 0;
    for (const double shift_mm : {0.0, 2.5, 5.0, 10.0, 17.0, 25.0}) {
        for (const bool sure : {false, true}) {
            MapNoise noise;
            noise.drift_m = std::max(noise.drift_m, 1e-3 * shift_mm - 1e-6);
            all.push_back({fmt::format("{} {}", sure ? "overconfident drift" : "drift", shift_mm),
                           machine,
                           map++,
                           sure ? overconfident(noise) : noise,
                           1e-3 * shift_mm});
        }
    }
    return all;
}

/// Runs the scenes of one tier and counts the verdicts.
class Campaign {
  public:
    Campaign(std::string tier,
             std::string folder,
             const Machine& machine,
             std::vector<Variant> variants)
        : tier_(std::move(tier)),
          folder_(std::move(folder)),
          machine_(machine),
          variants_(std::move(variants)),
          rig_(camera::Rectifier::make(*sim::rig_preset("zed_vga")).value().rig()),
          rater_(*traversability::preset("rex_zed")) {}

    /// Runs the scenes of one chunk, with and without hazards.
    [[nodiscard]] Status run_chunk(Hazard kind,
                                   std::uint64_t seed,
                                   std::uint64_t from,
                                   std::uint64_t count) {
        const std::string stem =
            fmt::format("{}/{}_{}_{}", folder_, kHazardNames[static_cast<int>(kind)], seed, from);
        if (io::is_file(stem + ".csv")) return {};
        Tally tally;
        for (std::uint64_t index = from; index < from + count; ++index) {
            for (const bool relief_only : {false, true}) {
                if (relief_only && index % safe_every() != 0) continue;
                Status done = is_run() ? ask_after_run(kind, relief_only, seed, index, tally)
                                       : ask_on_map(kind, relief_only, seed, index, tally);
                if (!done) return done;
            }
        }
        if (auto written = io::write_file(stem + ".misses.csv", tally.misses); !written)
            return written;
        if (is_run() && !tally.refused.empty()) {
            if (auto written = io::write_file(stem + ".refused.txt", tally.refused); !written)
                return written;
        }
        if (auto written = io::write_file(stem + ".part", tally.csv(kind)); !written)
            return written;
        std::filesystem::rename(stem + ".part", stem + ".csv");
        return {};
    }

  private:
    [[nodiscard]] std::uint64_t safe_every() const {
        if (tier_ == "maps") return kSafeEvery;
        return is_run() ? kSafeEveryOfRuns : 1;
    }
    [[nodiscard]] bool is_run() const {
        return tier_ == "depth" || tier_ == "images" || tier_ == "large";
    }
    [[nodiscard]] Status ask_on_map(
        Hazard kind, bool relief_only, std::uint64_t seed, std::uint64_t index, Tally& tally) {
        const Question question = draw(kind, relief_only, seed, index, machine_, Placing::anywhere);
        tally.add("scenes",
                  relief_only ? "drawn_safe" : "drawn_hazards",
                  question.draws > 0 ? question.draws : kMostDraws);
        if (question.draws == 0) {
            tally.add("scenes", relief_only ? "never_clear_safe" : "never_clear_hazards");
            return {};
        }
        const HazardScene& scene = question.scene;
        const SceneCells cells(scene, Sight(scene, rig_));
        std::vector<sim::SafetyAnswer> truths;
        if (index % kAllEvery == 0)
            truths = all_truths(scene.scene(), machine_, scene.T_world_body);
        int made = -1;
        MadeMap map;
        for (const Variant& variant : variants_) {
            if (variant.map != made) {
                made = variant.map;
                map = map_of(scene, cells, variant);
                if (auto taken = snapshot_of(map, scene.T_world_body, *snapshot_); !taken)
                    return taken;
                rater_.rate(map.height_m.view(), map.geometry.resolution_m, serial_, rating_);
            }
            const AskedMap asked{*snapshot_,
                                 map.geometry,
                                 rating_.traversability.view(),
                                 believed_pose(question, variant.shift_m)};
            ask_own(question, asked, variant, tally);
            if (!truths.empty()) ask_all(question, truths, asked, variant, tally);
        }
        return {};
    }

    [[nodiscard]] Status ask_after_run(
        Hazard kind, bool relief_only, std::uint64_t seed, std::uint64_t index, Tally& tally) {
        Question question = draw(kind, relief_only, seed, index, machine_, Placing::on_way);
        if (question.draws == 0) return {};
        const Look look = tier_ == "depth"   ? Look::analytic
                          : tier_ == "large" ? Look::large_images
                                             : Look::images;
        const auto run = run_chain(question.scene, look, 1.0, folder_, serial_);
        // A run without a map counts as a result, not as an error.
        if (!run) {
            fmt::print(stderr,
                       "{} {}: {}\n",
                       kHazardNames[static_cast<int>(kind)],
                       index,
                       run.error().message);
            tally.add("scenes", "no_map");
            return {};
        }
        if (auto taken = run->pipeline->snapshot(1, *snapshot_); !taken) return taken;
        const auto& geometry = run->pipeline->map().geometry();
        const Image<float> heights = run->pipeline->map().layers().height_m.copy();
        rater_.rate(heights.view(), geometry.resolution_m, serial_, rating_);
        const AskedMap asked{
            *snapshot_, geometry, rating_.traversability.view(), run->pipeline->T_odom_body()};
        // The end of the run is up to 2 mm from the planned pose; the truth uses the real end.
        const auto truths = all_truths(run->source->truth().scene, machine_, run->T_world_body);
        question.truth = truths[static_cast<std::size_t>(question.scene.command - 1)];
        const bool still = question.truth.clear_cut && can_stand(question.truth) &&
                           question.truth.safe == relief_only;
        tally.add("scenes", still ? "kept" : "not_clear_any_more");
        for (const Variant& variant : variants_) {
            if (still) ask_own(question, asked, variant, tally);
            ask_all(question, truths, asked, variant, tally);
        }
        return {};
    }

    std::string tier_;
    std::string folder_;
    Machine machine_;
    std::vector<Variant> variants_;
    camera::RectifiedRig rig_;
    traversability::Traversability rater_;
    traversability::TraversabilityLayers rating_;
    Serial serial_;
    std::unique_ptr<grid::MapSnapshot> snapshot_ = std::make_unique<grid::MapSnapshot>();
};

/// Scales the limits so that a larger `factor` is looser, up to the values that a machine file may
/// state: divides the margin of the feet and the band for drops, multiplies the others.
void loosen(GateLimits& limits, double factor) {
    const auto times = [factor](std::int32_t& limit, std::int32_t most) {
        limit = std::min(most, static_cast<std::int32_t>(std::lround(factor * limit)));
    };
    times(limits.step[0].up_tenth_mm, 3'000);
    times(limits.step[0].down_tenth_mm, 3'000);
    times(limits.patch_residual_tenth_mm, 500);
    times(limits.patch_sigma_tenth_mm, 100);
    times(limits.cell_sigma_tenth_mm, 300);
    times(limits.swing_clearance_tenth_mm, 2'000);
    times(limits.drop_tenth_mm, 1'000);
    limits.min_normal_z = std::max(0.98, std::cos(factor * std::acos(limits.min_normal_z)));
    limits.foot_margin_tenth_mm = static_cast<std::int32_t>(limits.foot_margin_tenth_mm / factor);
    limits.drop_band_tenth_mm =
        std::max(500, static_cast<std::int32_t>(limits.drop_band_tenth_mm / factor));
}

/// Returns the variants of the tier `curve`: scaled noise, single changed limits, and all limits
/// scaled together. Limits on uncertainty are tested at noise 1. Limits on heights are tested on
/// the overconfident map, because its small stated sigmas leave the decision to these limits. The
/// name of a variant ends with the limit or the factor.
std::vector<Variant> curve_variants(const Machine& machine) {
    std::vector<Variant> all;
    int map = 0;
    MapNoise noise;
    const auto with = [&](const char* name, std::initializer_list<double> values, auto&& change) {
        for (const double value : values) {
            Variant changed{fmt::format("{} {}", name, value), machine, map, noise};
            change(changed.machine.limits, value);
            if (changed.machine.problem() == nullptr) all.push_back(std::move(changed));
        }
    };
    const auto tenth_mm = [](double mm) {
        return static_cast<std::int32_t>(std::lround(10.0 * mm));
    };
    with("sigma_factor", {3.0, 5.0, 7.0}, [](GateLimits& l, double v) { l.sigma_factor = v; });
    with("patch_residual_mm", {10.0, 15.0, 50.0}, [&](GateLimits& l, double v) {
        l.patch_residual_tenth_mm = tenth_mm(v);
    });
    with("patch_sigma_mm", {2.0, 4.0, 10.0}, [&](GateLimits& l, double v) {
        l.patch_sigma_tenth_mm = tenth_mm(v);
    });
    with("every_limit", {0.75, 1.5, 2.0, 3.0, 5.0}, loosen);
    for (const double factor : {1.0, 0.5, 1.5, 2.0, 3.0, 4.0}) {
        all.push_back({fmt::format("noise {}", factor), machine, map++, MapNoise().times(factor)});
    }
    noise = overconfident(MapNoise());
    with("step_mm", {10.0, 15.0, 30.0, 40.0, 60.0, 100.0}, [&](GateLimits& l, double v) {
        l.step[0].up_tenth_mm = l.step[0].down_tenth_mm = tenth_mm(v);
    });
    with("drop_mm", {25.0, 35.0, 70.0, 100.0}, [&](GateLimits& l, double v) {
        l.drop_tenth_mm = tenth_mm(v);
    });
    with("swing_clearance_mm", {15.0, 25.0, 60.0, 80.0, 120.0}, [&](GateLimits& l, double v) {
        l.swing_clearance_tenth_mm = tenth_mm(v);
    });
    for (const double factor : {1.0, 2.0, 4.0, 6.0})
        all.push_back({fmt::format("overconfident {}", factor),
                       machine,
                       map++,
                       overconfident(MapNoise().times(factor))});
    return all;
}

/// Repeats one scene and writes the cells that the gate reads.
int show_again(const std::string& folder,
               const std::string& kind_name,
               const std::string& seed,
               const Machine& machine) {
    const auto* const at = std::find(std::begin(kHazardNames), std::end(kHazardNames), kind_name);
    if (at == std::end(kHazardNames))
        return app::report(usage_error("unknown kind of hazard: " + kind_name));
    const auto kind = static_cast<Hazard>(at - std::begin(kHazardNames));
    const HazardScene scene = make_hazard_scene(
        kind, false, std::strtoull(seed.c_str(), nullptr, 10), machine, Placing::anywhere);
    const auto truth = sim::judge(scene.scene(), machine, scene.T_world_body, scene.command);
    fmt::print("movement {}, {}\n", scene.command, truth.sentence());
    const camera::RectifiedRig rig =
        camera::Rectifier::make(*sim::rig_preset("zed_vga")).value().rig();
    const SceneCells cells(scene, Sight(scene, rig));
    const auto snapshot = std::make_unique<grid::MapSnapshot>();
    std::string csv = "variant,x_m,y_m,low_mm,high_mm,under_mm,seen,map_mm,sigma_mm,clearance_mm\n";
    for (const Variant& variant : map_variants(machine)) {
        const MadeMap map = map_of(scene, cells, variant);
        if (auto taken = snapshot_of(map, scene.T_world_body, *snapshot); !taken)
            return app::report(taken.error());
        const gate::Verdict verdict = ask(machine, *snapshot, scene.T_world_body, scene.command);
        fmt::print("{}: {}\n",
                   variant.name,
                   gate::text_of(verdict, query_of(scene.command, scene.T_world_body), machine));
        for (std::size_t i = 0; i < cells.cells().size(); ++i) {
            const SceneCells::Cell& cell = cells.cells().data()[i];
            const auto nx = static_cast<std::size_t>(map.geometry.nx);
            const Eigen::Vector2d p =
                map.geometry.center_m({static_cast<int>(i % nx), static_cast<int>(i / nx)});
            csv += fmt::format("{},{:.4f},{:.4f},{:.1f},{:.1f},{:.1f},{},{:.1f},{:.1f},{:.1f}\n",
                               variant.name,
                               p.x(),
                               p.y(),
                               1e3F * cell.low_m,
                               1e3F * cell.high_m,
                               1e3F * cell.under_m,
                               cell.seen ? 1 : 0,
                               1e3F * map.height_m.data()[i],
                               1e3F * std::sqrt(map.variance_m2.data()[i]),
                               1e3F * map.clearance_m.data()[i]);
        }
    }
    const Status written = io::write_file(folder + "/again.csv", csv);
    return written ? 0 : app::report(written.error());
}

int run(const std::vector<std::string>& words) {
    const std::vector<std::string> tiers{
        "maps", "depth", "images", "large", "curve", "drift", "again"};
    const bool known =
        words.size() >= 4 && std::find(tiers.begin(), tiers.end(), words[0]) != tiers.end();
    if (!known)
        return app::report(
            usage_error("gate_scenes maps|depth|images|large|curve|drift SCRATCH FIRST_SEED SCENES "
                        "[KINDS [FROM]]"));
    const auto machine_file = app::load_machine("rex");
    if (!machine_file) return app::report(machine_file.error());
    const Machine& machine = (*machine_file)->machine;
    if (words[0] == "again") return show_again(words[1], words[2], words[3], machine);
    const std::string folder = words[1] + "/" + words[0];
    if (auto made = io::make_folder(folder); !made) return app::report(made.error());
    const std::uint64_t seed = std::strtoull(words[2].c_str(), nullptr, 10);
    const std::uint64_t scenes = std::strtoull(words[3].c_str(), nullptr, 10);
    const auto names =
        words.size() > 4 ? io::split(words[4], ",") : std::vector<std::string_view>{};
    for (const std::string_view name : names) {
        if (std::find(std::begin(kHazardNames), std::end(kHazardNames), name) ==
            std::end(kHazardNames))
            return app::report(usage_error(fmt::format("KINDS: there is no hazard '{}'", name)));
    }
    std::vector<Hazard> kinds;
    for (int kind = 0; kind < kHazards; ++kind) {
        const std::string_view name = kHazardNames[kind];
        if (names.empty() || std::find(names.begin(), names.end(), name) != names.end())
            kinds.push_back(static_cast<Hazard>(kind));
    }
    std::vector<Variant> variants;
    if (words[0] == "maps") {
        variants = map_variants(machine);
    } else if (words[0] == "curve") {
        variants = curve_variants(machine);
    } else if (words[0] == "drift") {
        variants = drift_variants(machine);
    } else {
        variants.push_back({"noise 1", machine});
    }
    const std::uint64_t chunk = words[0] == "maps"                           ? 250
                                : words[0] == "curve" || words[0] == "drift" ? 50
                                                                             : 1;
    const std::uint64_t first = words.size() > 5 ? std::strtoull(words[5].c_str(), nullptr, 10) : 0;
    Campaign campaign(words[0], folder, machine, std::move(variants));
    for (std::uint64_t from = first; from < scenes; from += chunk) {
        for (const Hazard kind : kinds) {
            if (auto done = campaign.run_chunk(kind, seed, from, std::min(chunk, scenes - from));
                !done)
                return app::report(done.error());
        }
        fmt::print(stderr, "{} {} {}\r", words[0], seed, from + chunk);
    }
    return 0;
}

}  // namespace
}  // namespace surefoot::experiments

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape)
    return surefoot::experiments::run({argv + 1, argv + argc});
}
