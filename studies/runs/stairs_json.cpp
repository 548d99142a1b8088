// SPDX-License-Identifier: Apache-2.0
#include "studies/runs/stairs_json.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>

#include "service/gate_process/protocol/json_text.hpp"
#include "service/page/feature_lists.hpp"

namespace surefoot::app {
namespace {

using gate_process::dump_indented;
using gate_process::Json;
using gate_process::number;

Json classes_json(const stairs::GroundClasses& classes, double resolution_m) {
    const auto counts = stairs::count_classes(classes);
    Json json = Json::object();
    for (std::size_t i = 0; i < counts.size(); ++i)
        json[stairs::kGroundClassNames[i]] = {{"cells", counts[i]},
                                              {"area_m2", counts[i] * resolution_m * resolution_m}};
    return json;
}

constexpr gate_process::JsonLimits kFileLimits{.max_bytes = 64U << 20U};

/// Reads the objects of a list and keeps the first error.
class ListReader {
  public:
    explicit ListReader(std::string file) : file_(std::move(file)) {}

    [[nodiscard]] const std::optional<Error>& error() const { return error_; }

    /// Calls `read(object)` for each object of the list. Returns false if the list is missing.
    template <typename Read>
    bool each(const Json& all, const std::string& list, const Read& read) {
        if (!all.contains(list)) return false;
        if (!all[list].is_array()) fail(list, "is not a list");
        for (std::size_t i = 0; i < all[list].size() && !error_; ++i) {
            at_ = fmt::format("{}[{}]", list, i);
            if (!all[list][i].is_object()) fail("", "is not an object");
            if (!error_) read(all[list][i]);
        }
        return true;
    }

    /// Returns NaN if the member is missing.
    double number(const Json& object, const char* name) {
        if (!object.contains(name) || object[name].is_null())
            return std::numeric_limits<double>::quiet_NaN();
        if (!object[name].is_number()) fail(name, "is not a number");
        return error_ ? 0.0 : object[name].get<double>();
    }
    bool flag(const Json& object, const char* name, bool otherwise) {
        if (!object.contains(name)) return otherwise;
        if (!object[name].is_boolean()) fail(name, "is not true or false");
        return error_ ? otherwise : object[name].get<bool>();
    }
    int count(const Json& object, const char* name) {
        constexpr int kMost = 10000;
        const bool whole = object.contains(name) && object[name].is_number_integer();
        if (!whole || object[name].get<double>() < 0 || object[name].get<double>() > kMost)
            fail(name, fmt::format("is not a whole number from 0 to {}", kMost));
        return error_ ? 0 : object[name].get<int>();
    }
    bool leads_down(const Json& object) {
        const bool text = object.contains("kind") && object["kind"].is_string();
        const std::string kind = text ? object["kind"].get<std::string>() : "";
        if (kind != "up" && kind != "down") fail("kind", "is not \"up\" or \"down\"");
        return kind == "down";
    }
    template <int kSize>
    Eigen::Matrix<double, kSize, 1> numbers(const Json& object, const char* name) {
        Eigen::Matrix<double, kSize, 1> values = Eigen::Matrix<double, kSize, 1>::Zero();
        const bool list = object.contains(name) && object[name].is_array() &&
                          object[name].size() == static_cast<std::size_t>(kSize);
        if (!list) fail(name, fmt::format("is not a list of {} numbers", kSize));
        for (int i = 0; i < kSize && !error_; ++i) {
            const Json& value = object[name][static_cast<std::size_t>(i)];
            if (!value.is_number()) fail(name, fmt::format("is not a list of {} numbers", kSize));
            if (!error_) values[i] = value.get<double>();
        }
        return values;
    }
    stairs::FeaturePose pose(const Json& object) {
        const Eigen::Vector4d values = numbers<4>(object, "pose");
        return {values.head<3>(), values[3]};
    }

  private:
    void fail(const std::string& name, const std::string& what) {
        if (error_) return;
        const std::string where = at_.empty() || name.empty() ? at_ + name : at_ + "." + name;
        error_ = input_error(
            fmt::format("{}: {} {}; docs/reference/json.md describes the keys of stairs.json",
                        file_,
                        where,
                        what));
    }

    std::string file_;
    std::string at_;
    std::optional<Error> error_;
};

stairs::LineFeature line_of(ListReader& reader, const Json& object, bool down) {
    stairs::LineFeature line;
    line.pose = reader.pose(object);
    const double height_m = std::abs(reader.number(object, "height_m"));
    line.height_m = std::copysign(height_m, down ? -1.0 : 1.0);
    line.length_m = reader.number(object, "length_m");
    line.bottom_seen = reader.flag(object, "bottom_seen", true);
    return line;
}

stairs::Flight flight_of(ListReader& reader, const Json& object) {
    stairs::Flight flight;
    flight.kind = reader.leads_down(object) ? stairs::FlightKind::down : stairs::FlightKind::up;
    flight.pose = reader.pose(object);
    flight.steps = reader.count(object, "steps");
    flight.riser_m = reader.number(object, "riser_m");
    flight.going_m = reader.number(object, "going_m");
    flight.width_m = reader.number(object, "width_m");
    return flight;
}

stairs::Door door_of(ListReader& reader, const Json& object) {
    stairs::Door door;
    door.pose = reader.pose(object);
    door.width_m = reader.number(object, "width_m");
    door.sill_m = reader.number(object, "sill_m");
    return door;
}

stairs::Edge edge_of(ListReader& reader, const Json& object) {
    stairs::Edge edge;
    edge.from_m = reader.numbers<2>(object, "from");
    edge.to_m = reader.numbers<2>(object, "to");
    edge.upper_m = reader.number(object, "upper_m");
    edge.lower_m = reader.number(object, "lower_m");
    edge.lower_seen = reader.flag(object, "lower_seen", true);
    return edge;
}

Json figures_json(const eval::MatchErrors& figures) {
    return {{"count", figures.count},
            {"mean_m", number(figures.mean_m)},
            {"std_m", number(figures.std_m)},
            {"max_abs_m", number(figures.max_abs_m)}};
}

Json poses_json(const std::vector<stairs::FeaturePose>& poses) {
    Json list = Json::array();
    for (const stairs::FeaturePose& pose : poses)
        list.push_back({pose.p_m.x(), pose.p_m.y(), pose.p_m.z(), pose.yaw_rad});
    return list;
}

/// `height`: JSON name of the height of this kind.
Json kind_json(const eval::KindErrors& errors, const char* height) {
    return {{"truth", errors.truth},
            {"found", errors.found},
            {"matched", errors.matched},
            {"recall", number(errors.recall())},
            {"precision", number(errors.precision())},
            {"across", figures_json(errors.across)},
            {height, figures_json(errors.height)},
            {"missed", poses_json(errors.missed)},
            {"extra", poses_json(errors.extra)}};
}

}  // namespace

Result<ListedFeatures> parse_stairs(std::string_view text, const std::string& file) {
    const auto all = gate_process::parse_json(text, kFileLimits);
    if (!all) return input_error(fmt::format("{}: {}", file, all.error().message));
    if (!all->is_object())
        return input_error(
            fmt::format("{}: the file is not a JSON object; give a stairs.json", file));
    ListedFeatures out;
    stairs::TerrainFeatures& features = out.features;
    ListReader reader(file);
    const auto read = [&](const char* list, const auto& add) {
        if (reader.each(*all, list, add)) out.lists.insert(list);
    };
    read("flights",
         [&](const Json& object) { features.flights.push_back(flight_of(reader, object)); });
    read("drops",
         [&](const Json& object) { features.drops.push_back(line_of(reader, object, true)); });
    read("kerbs", [&](const Json& object) {
        features.kerbs.push_back(line_of(reader, object, reader.leads_down(object)));
    });
    read("sills",
         [&](const Json& object) { features.sills.push_back(line_of(reader, object, false)); });
    read("doors", [&](const Json& object) { features.doors.push_back(door_of(reader, object)); });
    read("edges", [&](const Json& object) { features.edges.push_back(edge_of(reader, object)); });
    if (reader.error()) return *reader.error();
    if (out.lists.empty()) {
        return input_error(
            fmt::format("{}: the file has no list of flights, drops, kerbs, sills, doors or edges; "
                        "give a stairs.json",
                        file));
    }
    return out;
}

std::string feature_errors_json(const eval::FeatureErrors& errors,
                                const std::set<std::string>& lists) {
    Json flights = kind_json(errors.flights, "riser");
    flights["steps_right"] = errors.flights.steps_right;
    flights["going"] = figures_json(errors.flights.going);
    flights["width"] = figures_json(errors.flights.width);
    Json doors = kind_json(errors.doors, "sill");
    doors["width"] = figures_json(errors.doors.width);
    Json json = {{"flights", flights},
                 {"drops", kind_json(errors.drops, "height")},
                 {"kerbs", kind_json(errors.kerbs, "height")},
                 {"sills", kind_json(errors.sills, "height")},
                 {"doors", doors},
                 {"edges", kind_json(errors.edges, "height")}};
    for (auto& [name, value] : json.items()) {
        if (!lists.contains(name)) value = nullptr;
    }
    return dump_indented(json);
}

namespace {

Json log10_of(double log_ratio) {
    return number(log_ratio / std::numbers::ln10);
}

/// Returns the log ratio of the least certain step, which represents the flight.
double least_log_ratio(const stairs::Flight& flight) {
    double least = std::numeric_limits<double>::quiet_NaN();
    for (const stairs::Edge& edge : flight.edges)
        if (!std::isnan(edge.log_step_ratio) && !(least <= edge.log_step_ratio))
            least = edge.log_step_ratio;
    return least;
}

void add_evidence(const stairs::Flight& flight, Json& json) {
    json["log10_step_ratio"] = log10_of(least_log_ratio(flight));
}
void add_evidence(const stairs::LineFeature& line, Json& json) {
    json["log10_step_ratio"] = log10_of(line.log_step_ratio);
}
void add_evidence(const stairs::Edge& edge, Json& json) {
    json["log10_step_ratio"] = log10_of(edge.log_step_ratio);
}
void add_evidence(const stairs::Door&, Json&) {}

template <typename Feature>
void add_marks(const std::vector<Feature>& features, bool gravity_assumed, Json& list) {
    for (std::size_t i = 0; i < features.size(); ++i) {
        add_evidence(features[i], list[i]);
        const stairs::Tracked& tracked = features[i].tracked;
        if (tracked.in_final_map) {
            list[i]["observations"] = tracked.observations;
            list[i]["in_final_map"] = *tracked.in_final_map;
        }
        if (gravity_assumed) list[i]["gravity_assumed"] = true;
    }
}

/// Returns the lists with marks. The web page gets the same lists without the marks.
Json marked_lists(const stairs::TerrainFeatures& features, bool gravity_assumed) {
    Json json = page::feature_lists(features);
    add_marks(features.flights, gravity_assumed, json["flights"]);
    add_marks(features.drops, gravity_assumed, json["drops"]);
    add_marks(features.kerbs, gravity_assumed, json["kerbs"]);
    add_marks(features.sills, gravity_assumed, json["sills"]);
    add_marks(features.doors, gravity_assumed, json["doors"]);
    add_marks(features.edges, gravity_assumed, json["edges"]);
    return json;
}

}  // namespace

const char* gravity_name(grid::GravitySource source) {
    switch (source) {
        case grid::GravitySource::imu: return "imu";
        case grid::GravitySource::plane: return "plane";
        case grid::GravitySource::assumed: return "assumed";
    }
    return "assumed";
}

std::string gravity_note(grid::GravitySource source) {
    if (source != grid::GravitySource::assumed) return "";
    return "gravity was assumed: the unknown tilt of the camera falsifies all heights, slopes, "
           "steps and drops (run with an IMU, or set mount.pitch_deg)";
}

std::string stairs_json(const stairs::TerrainFeatures& features,
                        const stairs::GroundClasses& classes,
                        const StairsContext& context) {
    const bool gravity_assumed = context.gravity_source == grid::GravitySource::assumed;
    Json json = marked_lists(features, gravity_assumed);
    json["classes"] = classes_json(classes, context.resolution_m);
    json["assumed"] = context.assumed;
    json["gravity_source"] = gravity_name(context.gravity_source);
    if (context.unconfirmed != nullptr)
        json["unconfirmed"] = marked_lists(*context.unconfirmed, gravity_assumed);
    return dump_indented(json);
}

}  // namespace surefoot::app
