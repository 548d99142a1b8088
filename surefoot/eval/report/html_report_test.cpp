// SPDX-License-Identifier: Apache-2.0
#include "surefoot/eval/report/html_report.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>
#include <vector>

namespace surefoot::eval {
namespace {

std::size_t count_of(const std::string& text, const std::string& part) {
    std::size_t count = 0;
    for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
    return count;
}

/// First error in the nesting of tags or in the use of '<' and '&'; no value if there is none.
std::string structure_problem(const std::string& html) {
    static const std::set<std::string> kVoid = {
        "meta", "img", "rect", "line", "polyline", "!DOCTYPE"};
    std::vector<std::string> open;
    for (std::size_t at = html.find('<'); at != std::string::npos; at = html.find('<', at + 1)) {
        const std::size_t end = html.find('>', at);
        if (end == std::string::npos) return "a tag without end";
        const std::string tag = html.substr(at + 1, end - at - 1);
        if (tag.find('<') != std::string::npos) return "'<' inside <" + tag;
        const bool closes = tag[0] == '/';
        const std::string name = tag.substr(closes, tag.find_first_of(" /", closes) - closes);
        if (kVoid.count(name) != 0) continue;
        if (!closes) {
            open.push_back(name);
            if (name == "style") at = html.find("</style>", at) - 1;
        } else if (open.empty() || open.back() != name) {
            return "</" + name + "> closes " + (open.empty() ? "nothing" : open.back());
        } else {
            open.pop_back();
        }
    }
    return open.empty() ? "" : "never closed: " + open.back();
}

std::vector<FrameReport> frames(int count) {
    std::vector<FrameReport> reports;
    for (int k = 0; k < count; ++k) {
        FrameReport report;
        report.time_ns = k * 100'000'000LL;
        report.index = k;
        report.motion.health = k == 0 ? Health::lost : k == 3 ? Health::degraded : Health::ok;
        report.motion.reason = k == 0   ? HealthReason::first_frame
                               : k == 3 ? HealthReason::blur
                                        : HealthReason::none;
        report.stage_ms = {1.0, 8.0 + k, k % 2 == 0 ? 10.0 : 0.0, 0.0, 3.0, 2.0};
        report.fusion.points = 1000;
        report.fusion.gated_range = 250;
        report.fusion.cells_measured = 2000;
        reports.push_back(report);
    }
    return reports;
}

ReportContent full_content() {
    ReportContent content;
    content.title = "Run of <sim> & \"more\"";
    content.summary = {"One line.", "5 > 3 & 2 < 4"};
    content.pictures = {
        {"first", {1, 2, 3}, true}, {"second <b>", {4, 5, 6, 7}, false}, {"third", {9}, false}};
    content.figures = {{"ATE", "0.08", "m", "51 matched"}};
    content.reasons = {"The map is empty: floor < 6 m is not seen."};
    content.tables = {{"Numbers", {"a", "b"}, {{"1", "<2>"}}}};
    content.configuration = {"", {"key", "value"}, {{"stereo.disparities", "64"}}};
    content.footer = "end";
    add_frames(content, frames(20));
    return content;
}

TEST(HtmlReport, Base64OfTheStandard) {
    const auto encode = [](const std::string& text) {
        return base64(std::vector<std::uint8_t>(text.begin(), text.end()));
    };
    EXPECT_EQ(encode(""), "");  // RFC 4648 section 10
    EXPECT_EQ(encode("f"), "Zg==");
    EXPECT_EQ(encode("fo"), "Zm8=");
    EXPECT_EQ(encode("foo"), "Zm9v");
    EXPECT_EQ(encode("foobar"), "Zm9vYmFy");
    EXPECT_EQ(base64(std::vector<std::uint8_t>{0xfb, 0xff, 0xfe}), "+//+");
}

TEST(HtmlReport, TextIsEscaped) {
    EXPECT_EQ(escaped("<a href=\"x\">&'"), "&lt;a href=&quot;x&quot;&gt;&amp;&#39;");
    EXPECT_EQ(escaped(std::string("a\0b\x01", 4)), "a b ");
    EXPECT_EQ(escaped("Stra\xc3\x9f"
                      "e"),
              "Stra\xc3\x9f"
              "e");
}

TEST(HtmlReport, IsWellNestedAndSelfContained) {
    const std::string html = render_html(full_content());
    EXPECT_EQ(structure_problem(html), "");
    EXPECT_EQ(count_of(html, "http"), 0u);
    EXPECT_EQ(count_of(html, "<script"), 0u);
    EXPECT_EQ(count_of(html, "<link"), 0u);
    EXPECT_EQ(count_of(html, "url("), 0u);
    EXPECT_EQ(count_of(html, "src="), count_of(html, "src=\"data:image/png;base64,"));
}

TEST(HtmlReport, HoldsEveryPictureOnceAndFirst) {
    const ReportContent content = full_content();
    const std::string html = render_html(content);
    std::size_t last = 0;
    for (const ReportPicture& picture : content.pictures) {
        EXPECT_EQ(count_of(html, "base64," + base64(picture.png) + "\""), 1u) << picture.caption;
        EXPECT_GT(html.find(base64(picture.png) + "\""), last);
        last = html.find(base64(picture.png) + "\"");
    }
    EXPECT_LT(last, html.find("Key figures"));
    EXPECT_EQ(count_of(html, "figure class=\"wide\""), 1u);
}

TEST(HtmlReport, ShowsEveryPart) {
    const std::string html = render_html(full_content());
    for (const char* part : {"Run of &lt;sim&gt; &amp; &quot;more&quot;",
                             "5 &gt; 3",
                             "0.08",
                             "51 matched",
                             "The map is empty",
                             "odometry",
                             "stereo",
                             "Health of the motion estimate",
                             "first frame",
                             "blur",
                             "&lt;2&gt;",
                             "stereo.disparities",
                             "too near or too far",
                             "(25.0 %)",
                             "20\u202f000",
                             "end</footer>"}) {
        EXPECT_NE(html.find(part), std::string::npos) << part;
    }
    EXPECT_EQ(count_of(html, "<svg"), 3u);
    EXPECT_EQ(count_of(html, "nan"), 0u);
    EXPECT_EQ(count_of(html, "inf"), 0u);
}

TEST(HtmlReport, EmptyPartsLeaveNoHeading) {
    ReportContent content;
    content.title = "empty";
    const std::string html = render_html(content);
    EXPECT_EQ(structure_problem(html), "");
    EXPECT_EQ(count_of(html, "<h2>"), 0u);
    add_frames(content, {});
    EXPECT_EQ(render_html(content), html);
    add_frames(content, frames(1));
    EXPECT_EQ(structure_problem(render_html(content)), "");
    EXPECT_EQ(count_of(render_html(content), "nan"), 0u);
}

TEST(HtmlReport, PlotsThumbnailsAndFoldedTables) {
    ReportContent content;
    content.title = "t";
    content.plots_title = "How far off";
    content.plots.push_back({"plot", "<svg></svg>", "a & b"});
    content.thumbnails_title = "Worst cases";
    content.thumbnails.push_back({"<floor>", {1, 2, 3}});
    content.tables.push_back({"Every case", {"a"}, {{"1"}}, "hint", true, true});
    content.tables.push_back({"Empty", {"a"}, {}, "hint", true, true});
    const std::string html = render_html(content);
    EXPECT_EQ(structure_problem(html), "");
    EXPECT_LT(html.find("How far off"), html.find("Worst cases"));
    EXPECT_NE(html.find("<summary>Every case</summary>"), std::string::npos);
    EXPECT_NE(html.find("&lt;floor&gt;"), std::string::npos);
    EXPECT_NE(html.find("a &amp; b"), std::string::npos);
    EXPECT_EQ(html.find("Empty"), std::string::npos);
    EXPECT_EQ(count_of(html, "<details>"), 1u);
    EXPECT_EQ(count_of(html, "class=\"card wide\""), 1u);
}

TEST(SvgPlot, BinPlotIsToScaleAndBreaksWhereNothingIs) {
    BinPlot plot;
    plot.x_label = "range [m]";
    plot.unit = "mm";
    plot.edges = {0.0, 1.0, 2.0, 3.0, 4.0, 5.0};
    const double none = std::nan("");
    EXPECT_EQ(bin_plot_svg(plot), "");
    plot.lines.push_back({"median", {none, 2.0, none, 4.0, none}});
    plot.high = 8.0;
    const std::string svg = bin_plot_svg(plot);
    EXPECT_EQ(structure_problem(svg), "");
    EXPECT_EQ(count_of(svg, "<circle"), 2u);
    EXPECT_EQ(count_of(svg, "<polyline"), 2u);
    EXPECT_EQ(count_of(svg, "nan"), 0u);
    // The axis begins with the first bin that holds something (x 62) and ends with the last (584):
    // the middle of [1, 2] is at a sixth of it; 2 of 8 mm is a quarter of the way up (214 to 34).
    EXPECT_NE(svg.find("cx=\"149.0\" cy=\"169.0\""), std::string::npos) << svg;
    EXPECT_NE(svg.find("cx=\"497.0\" cy=\"124.0\""), std::string::npos) << svg;
}

TEST(HtmlReport, ASectionHasItsPicturesTablesAndNote) {
    ReportContent content = full_content();
    content.sections = {{"Edges & stairs",
                         {{"from above", {1, 2, 3}, true}},
                         {{"Flights", {"what"}, {{"up, 4 steps"}}}},
                         "1 flight."},
                        {"Nothing to show", {}, {{"Empty", {"what"}, {}}}, ""}};
    const std::string html = render_html(content);
    const std::size_t begin = html.find("<h2>Edges &amp; stairs</h2>");
    ASSERT_NE(begin, std::string::npos);
    const std::string part = html.substr(begin, html.find("</section>", begin) - begin);
    EXPECT_LT(part.find("from above"), part.find("<h3>Flights</h3>"));
    EXPECT_NE(part.find("<td>up, 4 steps</td>"), std::string::npos) << part;
    EXPECT_NE(part.find("1 flight."), std::string::npos);
    EXPECT_LT(begin, html.find("<h2>Key figures</h2>"));
    EXPECT_EQ(html.find("Nothing to show"), std::string::npos);
}

TEST(HtmlReport, FramesBecomeTimesAndHealth) {
    ReportContent content;
    add_frames(content, frames(20));
    ASSERT_EQ(content.stages.size(), std::size_t{kStageCount});
    EXPECT_EQ(content.stages[1].ms.size(), 20u);
    EXPECT_EQ(content.stages[2].ms.size(), 10u);  // frames in which it did not run do not count
    EXPECT_EQ(content.stages[3].ms.size(), 0u);
    EXPECT_DOUBLE_EQ(content.frame_ms[2], 1.0 + 10.0 + 10.0 + 3.0 + 2.0);
    EXPECT_NEAR(content.frame_limit_ms, 100.0, 1e-9);
    EXPECT_EQ(content.health.size(), 20u);
    EXPECT_DOUBLE_EQ(content.health[3].time_s, 0.3);
}

TEST(HtmlReport, EveryReasonOfTheMotionIsCountedAndAGapOfTheImuIsExplained) {
    std::vector<FrameReport> reports = frames(20);
    ReportContent content;
    add_frames(content, reports);
    EXPECT_TRUE(content.reasons.empty());
    for (const std::size_t k : {5U, 6U, 7U}) reports[k].motion.reason = HealthReason::imu_gap;
    content = {};
    add_frames(content, reports);
    ASSERT_EQ(content.tables.size(), 1u);
    const std::vector<std::vector<std::string>> rows = {
        {"first frame", "1"}, {"blur", "1"}, {"imu gap", "3"}};
    EXPECT_EQ(content.tables[0].rows, rows);
    ASSERT_EQ(content.reasons.size(), 1u);
    EXPECT_NE(content.reasons[0].find("In at least 3 of 20 frames, IMU samples"), std::string::npos)
        << content.reasons[0];
}

TEST(SvgPlot, ASpikeSurvivesThinning) {
    std::vector<double> ms(10'000, 5.0);
    ms[7'777] = 50.0;
    const std::string svg = frame_times_svg(ms, 0.0);
    EXPECT_EQ(count_of(svg, "limit"), 0u);
    // The axis reaches 1.05 times the spike, whose point is therefore at 190 - 180 / 1.05.
    EXPECT_EQ(count_of(svg, ",18.6 "), 1u);
}

TEST(SvgPlot, StageBarsAreToScale) {
    const std::string svg = stage_bars_svg({{"a", {10.0, 10.0}}, {"none", {}}, {"b", {5.0}}});
    // The plot is 600 - 100 - 174 wide.
    EXPECT_EQ(count_of(svg, "width=\"326.0\" height=\"18.0\" class=\"median\""), 1u) << svg;
    EXPECT_EQ(count_of(svg, "width=\"163.0\" height=\"18.0\" class=\"median\""), 1u);
    EXPECT_EQ(count_of(svg, "none"), 0u);
    EXPECT_TRUE(stage_bars_svg({}).empty());
}

TEST(SvgPlot, HealthBandsCoverTheRun) {
    const std::string svg = health_svg({{0.0, Health::ok, {}},
                                        {1.0, Health::ok, {}},
                                        {2.0, Health::lost, HealthReason::blur},
                                        {3.0, Health::ok, {}}});
    EXPECT_EQ(count_of(svg, "<title>"), 3u);
    EXPECT_EQ(count_of(svg, "x=\"0.0\" y=\"0.0\" width=\"610.0\" height=\"34.0\" class=\"ok\""), 1u)
        << svg;
    EXPECT_EQ(count_of(svg, "x=\"610.0\" y=\"0.0\" width=\"305.0\" height=\"34.0\" class=\"lost\""),
              1u);
    EXPECT_NE(svg.find("75.0 % (3 frames)"), std::string::npos);
}

}  // namespace
}  // namespace surefoot::eval
