// SPDX-License-Identifier: Apache-2.0
#include "surefoot/eval/report/html_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace surefoot::eval {
namespace {

constexpr const char* kStyle = R"css(
:root{color-scheme:light dark;--page:#f5f6f8;--card:#fff;--ink:#1c1e22;--soft:#5c626c;--line:#dfe2e7;
--median:#0072b2;--tail:#8fc1e3;--degraded:#e69f00;--lost:#a63600;--accent:#0072b2}
@media (prefers-color-scheme:dark){:root{--page:#15171b;--card:#1f2227;--ink:#eceef1;--soft:#a5abb5;
--line:#383d45;--median:#4aa8e0;--tail:#2b5f85;--degraded:#e69f00;--lost:#d8622c;--accent:#6fbdf0}}
*{box-sizing:border-box}
body{margin:0;background:var(--page);color:var(--ink);
font:16px/1.5 system-ui,-apple-system,"Segoe UI",Roboto,"Helvetica Neue",Arial,sans-serif}
main{max-width:1280px;margin:0 auto;padding:32px 24px 48px}
h1{font-size:2rem;line-height:1.2;margin:0 0 10px;letter-spacing:-.01em}
h2{font-size:1.2rem;margin:40px 0 14px}
h3{font-size:1rem;margin:0 0 12px}
.summary p{margin:0 0 4px;color:var(--soft);font-size:1.05rem;max-width:85ch}
.grid{display:grid;gap:20px;grid-template-columns:repeat(auto-fit,minmax(min(440px,100%),1fr))}
.pictures{margin-top:26px}
figure,.card{margin:0;background:var(--card);border:1px solid var(--line);border-radius:10px;
overflow:hidden}
figure.wide{grid-column:1/-1}
figure{display:flex;flex-direction:column;background:#fff}
figure img{display:block;width:100%;height:auto;margin:0 0 auto}
figcaption{padding:10px 16px 12px;font-size:.94rem;color:var(--soft);border-top:1px solid var(--line);
background:var(--card)}
.card{padding:18px 20px}
.card.wide{grid-column:1/-1}
.thumbnails{display:grid;gap:16px;grid-template-columns:repeat(auto-fill,minmax(min(290px,100%),1fr))}
.thumbnails figcaption{font-size:.84rem;padding:8px 12px 10px}
summary{cursor:pointer;font-weight:600}
details[open] summary{margin-bottom:12px}
.tiles{display:grid;gap:14px;grid-template-columns:repeat(auto-fill,minmax(min(190px,100%),1fr))}
.tile .label{font-size:.88rem;color:var(--soft)}
.tile .value{font-size:1.75rem;font-weight:650;line-height:1.25;font-variant-numeric:tabular-nums}
.tile .unit{font-size:1rem;font-weight:400;color:var(--soft);margin-left:.25em}
.tile .note{font-size:.84rem;color:var(--soft)}
ul.reasons{margin:0;padding-left:1.2em}
ul.reasons li{margin:.3em 0}
.scroll{overflow-x:auto}
table{border-collapse:collapse;width:100%;font-size:.93rem;font-variant-numeric:tabular-nums}
th,td{text-align:left;vertical-align:top;padding:6px 14px 6px 0;border-bottom:1px solid var(--line)}
th{color:var(--soft);font-weight:600}
tr:last-child td{border-bottom:0}
.config td:first-child{font-family:ui-monospace,Menlo,Consolas,"DejaVu Sans Mono",monospace;
font-size:.86rem}
.bars{display:grid;grid-template-columns:max-content 1fr max-content;gap:7px 14px;align-items:center;
font-size:.93rem;font-variant-numeric:tabular-nums}
.bars .track{height:14px;border-radius:3px;background:var(--line)}
.bars .fill{height:14px;border-radius:3px;background:var(--median)}
.bars .text{text-align:right}
svg{display:block;width:100%;height:auto;overflow:visible}
svg text{font-size:13.5px;fill:var(--ink)}
svg .label{fill:var(--soft)}
svg .value{font-variant-numeric:tabular-nums}
svg .axis{stroke:var(--line);stroke-width:1}
svg .median,svg .ok{fill:var(--median)}
svg .tail{fill:var(--tail)}
svg .degraded{fill:var(--degraded)}
svg .lost{fill:var(--lost)}
svg .line{fill:none;stroke:var(--median);stroke-width:1.6;stroke-linejoin:round}
svg .second{fill:none;stroke:var(--degraded);stroke-width:1.6;stroke-linejoin:round}
svg .mark{fill:var(--card)}
svg .limit{stroke:var(--lost);stroke-width:1.5;stroke-dasharray:6 5}
.hint{color:var(--soft);font-size:.88rem;margin:10px 0 0}
footer{margin-top:44px;padding-top:14px;border-top:1px solid var(--line);color:var(--soft);
font-size:.88rem}
@media print{:root{--page:#fff;--card:#fff;--ink:#000;--soft:#444;--line:#bbb;--median:#0072b2;
--tail:#8fc1e3;--lost:#a63600}
main{max-width:none;padding:0}figure,.card,tr{break-inside:avoid}h2{break-after:avoid}
.grid{grid-template-columns:1fr 1fr}}
)css";

std::string element(const char* tag, const std::string& text) {
    return fmt::format("<{0}>{1}</{0}>\n", tag, escaped(text));
}

std::string section(const std::string& title, const std::string& body) {
    if (body.empty()) return {};
    return fmt::format("<section>\n<h2>{}</h2>\n{}</section>\n", escaped(title), body);
}

std::string card(const std::string& title,
                 const std::string& body,
                 const std::string& hint = {},
                 const char* css_class = "card") {
    if (body.empty()) return {};
    const std::string heading = title.empty() ? "" : element("h3", title);
    const std::string note =
        hint.empty() ? "" : fmt::format("<p class=\"hint\">{}</p>\n", escaped(hint));
    return fmt::format("<div class=\"{}\">\n{}{}{}</div>\n", css_class, heading, body, note);
}

std::string pictures_html(const std::vector<ReportPicture>& pictures,
                          const char* css_class = "grid pictures") {
    if (pictures.empty()) return {};
    std::string html = fmt::format("<div class=\"{}\">\n", css_class);
    for (const ReportPicture& picture : pictures) {
        html += fmt::format(
            "<figure{}>\n<img alt=\"{}\" src=\"data:image/png;base64,{}\">\n"
            "<figcaption>{}</figcaption>\n</figure>\n",
            picture.wide ? " class=\"wide\"" : "",
            escaped(picture.caption),
            base64(picture.png),
            escaped(picture.caption));
    }
    return html + "</div>\n";
}

std::string figures_html(const std::vector<KeyFigure>& figures) {
    if (figures.empty()) return {};
    std::string html = "<div class=\"tiles\">\n";
    for (const KeyFigure& figure : figures) {
        const std::string note =
            figure.note.empty() ? ""
                                : fmt::format("<div class=\"note\">{}</div>", escaped(figure.note));
        html += fmt::format(
            "<div class=\"card tile\"><div class=\"label\">{}</div><div class=\"value\">{}"
            "<span class=\"unit\">{}</span></div>{}</div>\n",
            escaped(figure.label),
            escaped(figure.value),
            escaped(figure.unit),
            note);
    }
    return html + "</div>\n";
}

std::string reasons_html(const std::vector<std::string>& reasons) {
    if (reasons.empty()) return {};
    std::string html = "<ul class=\"reasons\">\n";
    for (const std::string& reason : reasons) html += element("li", reason);
    return card("", html + "</ul>\n");
}

std::string table_html(const ReportTable& table, const char* css_class) {
    if (table.rows.empty()) return {};
    std::string html = fmt::format("<div class=\"scroll\"><table class=\"{}\">\n", css_class);
    if (!table.header.empty()) {
        html += "<thead><tr>";
        for (const std::string& name : table.header) {
            html += fmt::format("<th>{}</th>", escaped(name));
        }
        html += "</tr></thead>\n";
    }
    html += "<tbody>\n";
    for (const auto& row : table.rows) {
        html += "<tr>";
        for (const std::string& cell : row) html += fmt::format("<td>{}</td>", escaped(cell));
        html += "</tr>\n";
    }
    return html + "</tbody></table></div>\n";
}

std::string bars_html(const ReportBars& bars) {
    double longest = 0.0;
    for (const auto& bar : bars.bars) longest = std::max(longest, bar.value);
    if (bars.bars.empty()) return {};
    std::string html = "<div class=\"bars\">\n";
    for (const auto& bar : bars.bars) {
        const double percent = longest > 0.0 ? 100.0 * bar.value / longest : 0.0;
        html += fmt::format(
            "<div>{}</div><div class=\"track\"><div class=\"fill\" "
            "style=\"width:{:.2f}%\"></div></div>"
            "<div class=\"text\">{}</div>\n",
            escaped(bar.label),
            percent,
            escaped(bar.text));
    }
    return html + "</div>\n";
}

std::string timing_html(const ReportContent& content) {
    const std::string cards =
        card("Per stage",
             stage_bars_svg(content.stages),
             "Thick bar: median time of the frames in which the stage ran. Thin bar: 99th "
             "percentile of the same frames.") +
        card("Per frame",
             frame_times_svg(content.frame_ms, content.frame_limit_ms),
             content.frame_limit_ms > 0.0 ? "Dashed line: time between two frames of the source."
                                          : "");
    return cards.empty() ? "" : "<div class=\"grid\">\n" + cards + "</div>\n";
}

std::string plots_html(const std::vector<ReportPlot>& plots) {
    std::string cards;
    for (const ReportPlot& plot : plots) cards += card(plot.title, plot.svg, plot.hint);
    return cards.empty() ? "" : "<div class=\"grid\">\n" + cards + "</div>\n";
}

std::string table_card(const ReportTable& table) {
    const char* css_class = table.wide ? "card wide" : "card";
    const std::string body = table_html(table, "plain");
    if (!table.folded || body.empty()) return card(table.title, body, table.hint, css_class);
    return card("",
                fmt::format("<details>\n{}{}</details>\n", element("summary", table.title), body),
                table.hint,
                css_class);
}

std::string details_html(const ReportContent& content) {
    std::string cards;
    for (const ReportBars& bars : content.bars) cards += card(bars.title, bars_html(bars));
    for (const ReportTable& table : content.tables) cards += table_card(table);
    return cards.empty() ? "" : "<div class=\"grid\">\n" + cards + "</div>\n";
}

std::string section_html(const ReportSection& part) {
    std::string cards;
    for (const ReportTable& table : part.tables) cards += table_card(table);
    if (!cards.empty()) cards = "<div class=\"grid\">\n" + cards + "</div>\n";
    const std::string note =
        part.note.empty() ? "" : fmt::format("<p class=\"hint\">{}</p>\n", escaped(part.note));
    return section(part.title, pictures_html(part.pictures) + cards + note);
}

}  // namespace

std::string base64(std::span<const std::uint8_t> bytes) {
    static constexpr const char* kDigits =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t k = 0; k < bytes.size(); k += 3) {
        const std::size_t left = std::min<std::size_t>(3, bytes.size() - k);
        std::uint32_t group = 0;
        for (std::size_t j = 0; j < 3; ++j) {
            group = (group << 8U) | (j < left ? bytes[k + j] : std::uint32_t{0});
        }
        for (std::size_t j = 0; j < 4; ++j) {
            text += j <= left ? kDigits[(group >> (18U - 6U * j)) & 63U] : '=';
        }
    }
    return text;
}

std::string render_html(const ReportContent& content) {
    std::string html = fmt::format(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
        "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n"
        "<title>{}</title>\n<style>{}</style>\n</head>\n<body>\n<main>\n<header "
        "class=\"summary\">\n",
        escaped(content.title),
        kStyle);
    html += element("h1", content.title);
    for (const std::string& line : content.summary) html += element("p", line);
    html += "</header>\n";
    html += pictures_html(content.pictures);
    for (const ReportSection& part : content.sections) html += section_html(part);
    html += section("Key figures", figures_html(content.figures));
    html += section("Reasons", reasons_html(content.reasons));
    html += section(content.plots_title, plots_html(content.plots));
    html += section(content.thumbnails_title, pictures_html(content.thumbnails, "thumbnails"));
    html += section("Time", timing_html(content));
    html += section("Health of the motion estimate", card("", health_svg(content.health)));
    html += section(content.details_title, details_html(content));
    html += section("Configuration", card("", table_html(content.configuration, "config")));
    if (!content.footer.empty()) html += element("footer", content.footer);
    return html + "</main>\n</body>\n</html>\n";
}

}  // namespace surefoot::eval
