// SPDX-License-Identifier: Apache-2.0
#include "surefoot/eval/stairs/stairs_picture.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "surefoot/core/unknown.hpp"

namespace surefoot::eval {
namespace {

constexpr int kLeft = layout::kMargin_px + layout::kAxisBand_px;
constexpr int kTop = layout::kTitleBand_px;
constexpr int kSide_px = 800;  ///< side of the map below

/// With the rim of two cells 4 m by 4 m from (0, -2), 40 cells of 20 px a side: 200 px a metre.
grid::GridGeometry square() {
    return {0.1, 36, 36, {0.2, -1.8}};
}

PointPx pixel_of(double x_m, double y_m) {
    return {kLeft + 200.0 * (2.0 - y_m), kTop + 200.0 * (4.0 - x_m)};
}

Overlays without_scale_bar() {
    Overlays overlays;
    overlays.scale_bar = false;
    return overlays;
}

Picture drawn(const stairs::TerrainFeatures& features, Overlays overlays = without_scale_bar()) {
    return render_features(
        square(), grid::Layer(36, 36, 0.0F), features, overlays, {"Edges and stairs", ""});
}

int count(const Picture& picture, const RectPx& rect, Rgb8 color) {
    int found = 0;
    for (int v = rect.top; v < rect.bottom(); ++v) {
        for (int u = rect.left; u < rect.right(); ++u) found += picture.at(u, v) == color ? 1 : 0;
    }
    return found;
}

/// Pixels of a colour on the map between two x.
int count_between(const Picture& picture, double low_x_m, double high_x_m, Rgb8 color) {
    const int top = static_cast<int>(pixel_of(high_x_m, 0.0).v);
    const int bottom = static_cast<int>(pixel_of(low_x_m, 0.0).v);
    return count(picture, {kLeft, top, kSide_px, bottom - top}, color);
}

/// Across the way along x at that x, 2 m long; the ground behind it lies higher by `height_m`.
stairs::LineFeature line_at(double x_m, double height_m) {
    stairs::LineFeature line;
    line.pose.p_m = {x_m, 0.0, 0.0};
    line.height_m = height_m;
    line.length_m = 2.0;
    line.sigma_m = 0.002;
    return line;
}

/// Three steps 1 m wide from x = 1 on, or the same steps from their upper end.
stairs::Flight flight_of(stairs::FlightKind kind) {
    stairs::Flight flight;
    flight.kind = kind;
    flight.steps = 3;
    flight.riser_m = 0.18;
    flight.riser_sigma_m = 0.001;
    flight.going_m = 0.30;
    flight.going_sigma_m = 0.0004;
    flight.width_m = 1.0;
    flight.landing_m = 1.0;
    for (int k = 0; k < 3; ++k) {
        stairs::Edge edge;
        const double x_m = 1.0 + 0.3 * k;
        // The lower ground is on the right-hand side: behind a person who walks up along x.
        edge.from_m = {x_m, 0.5};
        edge.to_m = {x_m, -0.5};
        if (kind == stairs::FlightKind::down) std::swap(edge.from_m, edge.to_m);
        flight.edges.push_back(edge);
    }
    flight.pose.p_m = {1.0, 0.0, 0.0};
    return flight;
}

TEST(StairsPicture, LengthsAreInMillimetresWithTheirSigma) {
    EXPECT_EQ(length_text(0.18, 0.001), "180 +- 1 mm");
    EXPECT_EQ(length_text(0.30004, 0.0004), "300.0 +- 0.4 mm");
    EXPECT_EQ(length_text(1.2345, 0.0123), "1234 +- 12 mm");
    EXPECT_EQ(length_text(0.18, std::nan("")), "180 mm");
    EXPECT_EQ(length_text(std::nan(""), 0.001), "?");
}

TEST(StairsPicture, AFlightSaysItsStepsAndWhatTheyMeasure) {
    stairs::Flight flight = flight_of(stairs::FlightKind::up);
    EXPECT_EQ(flight_text(flight), "up, 3 steps, 1.00 m wide\n180 +- 1 mm by 300.0 +- 0.4 mm");
    flight.kind = stairs::FlightKind::down;
    flight.steps = 1;
    flight.going_m = flight.going_sigma_m = std::nan("");
    EXPECT_EQ(flight_text(flight), "down, 1 step, 1.00 m wide\n180 +- 1 mm");
}

TEST(StairsPicture, NothingFoundIsTheMapAlone) {
    grid::Layer with_rim(40, 40, kNanF);
    for (int iy = 2; iy < 38; ++iy) {
        for (int ix = 2; ix < 38; ++ix) with_rim.at(ix, iy) = 0.0F;
    }
    LayerStyle style = elevation_style();
    style.map = ColorMap::pale;
    style.text = {"Edges and stairs", ""};
    const grid::GridGeometry around{0.1, 40, 40, {0.0, -2.0}};
    EXPECT_EQ(drawn({}), render_layer(around, with_rim, style, without_scale_bar()));
}

TEST(StairsPicture, ALineLiesWhereItWasFoundAndItsTicksAreOnTheLowerSide) {
    for (const double height_m : {-0.5, 0.5}) {
        stairs::TerrainFeatures features;
        (height_m < 0.0 ? features.drops : features.kerbs) = {line_at(2.0, height_m)};
        const Rgb8 color = height_m < 0.0 ? ground_palette::kDrop : ground_palette::kKerb;
        const Picture picture = drawn(features);
        // 2 m are 400 px.
        const PointPx middle = pixel_of(2.0, 0.0);
        const int u = static_cast<int>(middle.u);
        const int v = static_cast<int>(middle.v);
        EXPECT_GE(count(picture, {u - 198, v, 396, 1}, color), 390);
        EXPECT_EQ(count(picture, {kLeft, v, u - 210 - kLeft, 1}, color), 0);
        EXPECT_EQ(count(picture, {u + 210, v, kLeft + kSide_px - u - 210, 1}, color), 0);
        const int ahead = count(picture, {kLeft, v - 9, kSide_px, 1}, color);
        const int behind = count(picture, {kLeft, v + 8, kSide_px, 1}, color);
        // The way leads ahead: there lies what is lower behind a drop, and higher behind a kerb up.
        EXPECT_GE(height_m < 0.0 ? ahead : behind, 20) << height_m;
        EXPECT_EQ(height_m < 0.0 ? behind : ahead, 0) << height_m;
    }
}

TEST(StairsPicture, StepsAreDrawnAndNumberedAsTheyAreWalked) {
    for (const auto kind : {stairs::FlightKind::up, stairs::FlightKind::down}) {
        stairs::TerrainFeatures features;
        features.flights = {flight_of(kind)};
        features.edges = features.flights[0].edges;
        const bool up = kind == stairs::FlightKind::up;
        const Rgb8 color = up ? ground_palette::kUp : ground_palette::kDown;
        const Rgb8 other = up ? ground_palette::kDown : ground_palette::kUp;
        const Picture picture = drawn(features);
        for (int k = 0; k < 3; ++k) {
            const double x_m = 1.0 + 0.3 * k;
            EXPECT_GT(count_between(picture, x_m - 0.02, x_m + 0.02, color), 600) << k;
        }
        EXPECT_EQ(count_between(picture, 0.0, 4.0, other), 0);
        // The numbers stand at the left end as one walks, 0.14 of the edge from it.
        const auto disc = [&](double y_m) {
            const PointPx at = pixel_of(1.0, y_m);
            return count(
                picture, {static_cast<int>(at.u) - 10, static_cast<int>(at.v) - 10, 20, 6}, color);
        };
        EXPECT_GT(disc(0.36), 60);
        EXPECT_EQ(disc(-0.36), 0);
        // The arrow ends behind the last step.
        EXPECT_GT(count_between(picture, 1.65, 1.9, palette::kInk), 60);
        EXPECT_EQ(count_between(picture, 2.0, 2.5, palette::kInk), 0);
        // The steps are no further edges.
        EXPECT_EQ(with_features(features, {}).strokes.size(), 4U);
    }
}

TEST(StairsPicture, TheKeyNamesWhatIsDrawn) {
    stairs::TerrainFeatures features;
    features.drops = {line_at(2.0, -0.5), line_at(2.5, -0.25)};
    features.kerbs = {line_at(3.0, 0.15)};
    features.kerbs[0].bottom_seen = false;
    features.flights = {flight_of(stairs::FlightKind::up), flight_of(stairs::FlightKind::down)};
    stairs::Door door;
    door.width_m = 0.81;
    door.width_sigma_m = 0.005;
    features.doors = {door};
    stairs::Edge wall;
    wall.from_m = {3.9, -1.0};
    wall.to_m = {3.9, 1.0};
    features.edges = {wall};
    std::vector<std::string> labels;
    for (const KeyEntry& entry : key_of(with_features(features, {}))) labels.push_back(entry.label);
    const std::vector<std::string> expected = {"other edge",
                                               "drop: 0.25 to 0.50 m",
                                               "kerb: 0.15 m or more",
                                               "door: 810 +- 5 mm wide",
                                               "A: up, 3 steps, 1.00 m wide",
                                               "180 +- 1 mm by 300.0 +- 0.4 mm",
                                               "B: down, 3 steps, 1.00 m wide",
                                               "180 +- 1 mm by 300.0 +- 0.4 mm"};
    EXPECT_EQ(labels, expected);
}

TEST(StairsPicture, ManyFlightsAndDoorsDoNotFillThePage) {
    stairs::TerrainFeatures features;
    features.flights.assign(40, flight_of(stairs::FlightKind::up));
    stairs::Door door;
    door.width_m = 0.8;
    for (int k = 0; k < 40; ++k) {
        door.width_m += 0.001;
        features.doors.push_back(door);
    }
    const std::vector<KeyEntry> key = key_of(with_features(features, {}));
    EXPECT_LE(key.size(), 14U);
    EXPECT_EQ(key.back().label, "and 36 more flights");
    EXPECT_LE(drawn(features).height(), 1900);
}

TEST(StairsPicture, ADoorIsALineAcrossItsOpening) {
    stairs::TerrainFeatures features;
    stairs::Door door;
    door.pose = {{2.0, 0.0, 0.0}, 0.5 * std::numbers::pi};  // the passage leads along y
    door.width_m = 1.0;
    features.doors = {door};
    const Picture picture = drawn(features);
    const int u = static_cast<int>(pixel_of(2.0, 0.0).u);
    EXPECT_GE(count(picture, {u, kTop, 1, kSide_px}, ground_palette::kDoor), 195);
    EXPECT_LE(count(picture, {u, kTop, 1, kSide_px}, ground_palette::kDoor), 210);
}

TEST(StairsPicture, ShowsWhatIsKnownAndWhereOneStands) {
    const grid::GridGeometry geometry{0.1, 200, 200, {0.0, 0.0}};
    grid::Layer height_m(200, 200, kNanF);
    height_m.at(100, 100) = 0.0F;
    const Picture one = render_features(geometry, height_m, {}, without_scale_bar(), {"t", ""});
    Overlays overlays = without_scale_bar();
    overlays.marks = {{{19.95, 19.95}, "seen from here"}};
    const Picture with_stance = render_features(geometry, height_m, {}, overlays, {"t", ""});
    const Rgb8 ground = color_at(ColorMap::pale, 0.5);
    // 5 cells of 160 px a side: two around the known one.
    EXPECT_EQ(count(one, {kLeft, kTop, kSide_px, kSide_px}, ground), 160 * 160);
    // 104 cells of 8 px.
    EXPECT_EQ(count(with_stance, {kLeft, kTop, 104 * 8, 104 * 8}, ground), 8 * 8);
}

TEST(StairsPicture, OddInputDrawsWithoutHarm) {
    stairs::TerrainFeatures features;
    stairs::Flight flight = flight_of(stairs::FlightKind::up);
    flight.edges.clear();
    features.flights = {flight, flight_of(stairs::FlightKind::up)};
    features.flights[1].edges[1].from_m.setConstant(std::nan(""));
    features.flights[1].pose.yaw_rad = std::nan("");
    features.drops = {line_at(1e9, -0.5), line_at(std::nan(""), -0.5)};
    features.drops[0].length_m = 1e9;
    features.doors.resize(1);
    EXPECT_FALSE(drawn(features).empty());
    const grid::GridGeometry none{0.025, 0, 0, {0.0, 0.0}};
    EXPECT_FALSE(render_features(none, grid::Layer(), features, {}, {"", ""}).empty());
}

TEST(MapView, DotsLieAtTheirPlacesAndInTheKeyOnlyWhereThereAreSome) {
    MapView view;
    view.plot = {10, 20, 200, 100};
    view.x_max_m = 1.0;
    view.y_max_m = 2.0;
    view.px_per_m = 100.0;
    Picture picture(300, 200, palette::kPaper);
    Overlays overlays;
    overlays.scale_bar = false;
    overlays.dots.label = "something hangs";
    overlays.dots.color = {1, 2, 3};
    EXPECT_TRUE(key_of(overlays).empty());
    overlays.dots.points_m = {{0.5, 1.0}, {9.0, 9.0}};  // the second is beyond the plot
    draw_overlays(picture, view, overlays);
    EXPECT_EQ(picture.at(110, 70), overlays.dots.color);
    EXPECT_EQ(picture.at(112, 70), palette::kPaper);
    ASSERT_EQ(key_of(overlays).size(), 1U);
    EXPECT_EQ(key_of(overlays).front().label, "something hangs");
}

TEST(MapView, ABadgeThatWouldCoverAnEarlierOneIsLeftOut) {
    Overlays overlays = without_scale_bar();
    overlays.badges = {{{2.0, 0.0}, "1", palette::kSafe}};
    const Picture one = drawn({}, overlays);
    overlays.badges.push_back({{2.05, 0.0}, "2", palette::kUnsafe});
    EXPECT_EQ(drawn({}, overlays), one);
    overlays.badges.push_back({{2.5, 0.0}, "3", palette::kUnsafe});
    EXPECT_NE(drawn({}, overlays), one);
}

}  // namespace
}  // namespace surefoot::eval
