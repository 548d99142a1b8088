// SPDX-License-Identifier: Apache-2.0
#include "apps/surefoot/suite_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "eval/html_report.hpp"

namespace surefoot::app {
namespace {

SuiteRow& row_of(std::vector<SuiteRow>& rows, const SuiteCase& which) {
    for (SuiteRow& row : rows) {
        if (row.scene == which.scene && row.noise == which.noise) return row;
    }
    const auto after = std::find_if(
        rows.rbegin(), rows.rend(), [&](const SuiteRow& row) { return row.scene == which.scene; });
    SuiteRow row;
    row.scene = which.scene;
    row.noise = which.noise;
    return *rows.insert(after == rows.rend() ? rows.end() : after.base(), row);
}

std::string shown(double value) {
    return std::isnan(value) ? "-" : fmt::format("{:.4g}", value);
}

std::string with_unit(const SuiteFigure& figure) {
    return *figure.unit == '\0' ? figure.name : fmt::format("{} [{}]", figure.name, figure.unit);
}

eval::ReportTable summary_table(const SuiteFigure& figure,
                                std::size_t index,
                                std::span<const SuiteRow> rows) {
    eval::ReportTable table;
    table.title = fmt::format("{}: {}", with_unit(figure), figure.meaning);
    table.header = {"scene", "noise", "cases", "median", "worst"};
    for (const SuiteRow& row : rows) {
        table.rows.push_back({row.scene,
                              fmt::format("x {:g}", row.noise),
                              std::to_string(row.cases),
                              shown(row.median[index]),
                              shown(row.worst[index])});
    }
    return table;
}

eval::ReportTable case_table(std::span<const SuiteResult> results) {
    eval::ReportTable table;
    table.title = "Every case";
    table.header = {"case"};
    for (const SuiteFigure& figure : suite_figures()) table.header.push_back(with_unit(figure));
    for (const SuiteResult& result : results) {
        std::vector<std::string> row = {result.which.name()};
        for (const double value : result.figures) row.push_back(shown(value));
        table.rows.push_back(std::move(row));
    }
    return table;
}

}  // namespace

std::vector<SuiteRow> summarise(std::span<const SuiteResult> results) {
    std::vector<SuiteRow> rows;
    for (const SuiteResult& result : results) ++row_of(rows, result.which).cases;
    for (SuiteRow& row : rows) {
        for (std::size_t i = 0; i < suite_figures().size(); ++i) {
            std::vector<double> values;
            for (const SuiteResult& result : results) {
                if (result.which.scene == row.scene && result.which.noise == row.noise &&
                    !std::isnan(result.figures[i]))
                    values.push_back(result.figures[i]);
            }
            std::sort(values.begin(), values.end());
            const double none = std::nan("");
            row.median.push_back(values.empty() ? none : values[values.size() / 2]);
            row.worst.push_back(values.empty()                       ? none
                                : suite_figures()[i].lower_is_better ? values.back()
                                                                     : values.front());
        }
    }
    return rows;
}

std::string suite_html(std::span<const SuiteResult> results) {
    const std::vector<SuiteRow> rows = summarise(results);
    eval::ReportContent content;
    content.title = "Surefoot against the truth";
    content.summary = {
        fmt::format("{} simulated runs of {} scenes and noise levels through the whole chain; "
                    "nothing was aligned before the comparison.",
                    results.size(),
                    rows.size()),
        "Seeds from 10000 on were never used while building."};
    for (std::size_t i = 0; i < suite_figures().size(); ++i)
        content.tables.push_back(summary_table(suite_figures()[i], i, rows));
    content.tables.push_back(case_table(results));
    content.footer = fmt::format("surefoot {}", SUREFOOT_VERSION);
    return eval::render_html(content);
}

}  // namespace surefoot::app
