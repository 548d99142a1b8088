// SPDX-License-Identifier: Apache-2.0
#include "studies/suite/suite_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "surefoot/core/assert.hpp"
#include "surefoot/io/text.hpp"

namespace surefoot::app {
namespace {

constexpr const char* kCaseHead = "scene,motion_model,seed,noise,max_frames";
constexpr std::size_t kKeyColumns = 5;
constexpr std::size_t kCaseColumns = 6;  ///< number of columns before the figures
constexpr std::size_t kBinColumns = kKeyColumns + 8;
constexpr std::size_t kStepColumns = kKeyColumns + 9;
constexpr std::size_t kTallyColumns = kKeyColumns + 4;

using Words = std::vector<std::string_view>;

std::string key_of(const SuiteCase& c) {
    return fmt::format("{},{},{},{},{}", c.scene, c.motion_model, c.seed, c.noise, c.max_frames);
}

/// Replaces empty text by a dash. A column must not be empty, because the reader merges adjacent
/// separators.
const std::string& or_dash(const std::string& text) {
    static const std::string dash = "-";
    return text.empty() ? dash : text;
}
std::string from_dash(std::string_view text) {
    return text == "-" ? std::string() : std::string(text);
}

std::string cases_head() {
    std::string head = fmt::format("{},rate_hz", kCaseHead);
    for (const SuiteFigure& figure : suite_figures()) head += fmt::format(",{}", figure.name);
    return head + "\n";
}

std::string case_line(const SuiteResult& result) {
    const SuiteCase& c = result.which;
    std::string line = fmt::format("{},{}", key_of(c), c.rate_hz);
    for (const double figure : result.figures)
        line += fmt::format(",{}", figure);  // this format reads back to the same bits
    return line + "\n";
}

std::string bin_lines(const SuiteResult& result) {
    std::string lines;
    for (const SuiteBin& bin : result.bins) {
        lines += fmt::format("{},{},{},{},{},{:.6f},{:.6f},{:.6f},{}\n",
                             key_of(result.which),
                             kBinKeyNames[static_cast<std::size_t>(bin.key)],
                             bin.from,
                             bin.to,
                             bin.errors.count(),
                             bin.errors.percentile(0.5),
                             bin.errors.percentile(0.9),
                             bin.errors.percentile(0.99),
                             format_counts(bin.errors));
    }
    return lines;
}

std::string step_lines(const SuiteResult& result) {
    std::string lines;
    for (const SuiteStep& step : result.steps) {
        lines += fmt::format("{},{},{},{},{},{},{},{},{},{}\n",
                             key_of(result.which),
                             step.number,
                             step.time_s,
                             step.command,
                             step.safe ? 1 : 0,
                             step.clear_cut ? 1 : 0,
                             step.seen ? 1 : 0,
                             or_dash(step.dangers),
                             step.decision,
                             or_dash(step.reasons));
    }
    return lines;
}

std::string verdict_lines(const SuiteResult& result) {
    std::string lines;
    for (const VerdictTally& tally : result.tallies.all()) {
        lines += fmt::format("{},{},{},{},{}\n",
                             key_of(result.which),
                             kTallyKeyNames[static_cast<std::size_t>(tally.by)],
                             tally.name,
                             tally.named,
                             tally.alone);
    }
    return lines;
}

/// These parsers return an empty optional for an incomplete line.
std::optional<SuiteCase> parse_key(const Words& words) {
    const auto seed = io::parse_int64(words[2]);
    const auto noise = io::parse_double(words[3]);
    const auto frames = io::parse_int64(words[4]);
    if (!seed || !noise || !frames) return std::nullopt;
    SuiteCase which;
    which.scene = words[0];
    which.motion_model = words[1];
    which.seed = static_cast<std::uint64_t>(*seed);
    which.noise = *noise;
    which.max_frames = static_cast<int>(*frames);
    return which;
}

std::optional<SuiteResult> parse_case(const Words& words) {
    if (words.size() != kCaseColumns + suite_figures().size()) return std::nullopt;
    const auto which = parse_key(words);
    const auto rate_hz = io::parse_double(words[kKeyColumns]);
    if (!which || !rate_hz) return std::nullopt;
    SuiteResult result;
    result.which = *which;
    result.which.rate_hz = *rate_hz;
    for (std::size_t i = kCaseColumns; i < words.size(); ++i) {
        const auto figure =
            words[i] == "nan" ? std::optional<double>(std::nan("")) : io::parse_double(words[i]);
        if (!figure) return std::nullopt;
        result.figures.push_back(*figure);
    }
    return result;
}

std::optional<SuiteBin> parse_bin(const Words& words) {
    if (words.size() != kBinColumns) return std::nullopt;
    const auto name = std::find(std::begin(kBinKeyNames), std::end(kBinKeyNames), words[5]);
    const auto from = io::parse_double(words[6]);
    const auto to = io::parse_double(words[7]);
    const auto errors = parse_counts(words[12]);
    if (name == std::end(kBinKeyNames) || !from || !to || !errors) return std::nullopt;
    return SuiteBin{static_cast<BinKey>(name - std::begin(kBinKeyNames)), *from, *to, *errors};
}

std::optional<SuiteStep> parse_step(const Words& words) {
    if (words.size() != kStepColumns) return std::nullopt;
    const auto number = io::parse_int64(words[5]);
    const auto time_s = io::parse_double(words[6]);
    const auto command = io::parse_int64(words[7]);
    if (!number || !time_s || !command) return std::nullopt;
    return SuiteStep{static_cast<int>(*number),
                     *time_s,
                     static_cast<int>(*command),
                     words[8] == "1",
                     words[9] == "1",
                     words[10] == "1",
                     from_dash(words[11]),
                     std::string(words[12]),
                     from_dash(words[13])};
}

std::optional<VerdictTally> parse_tally(const Words& words) {
    if (words.size() != kTallyColumns) return std::nullopt;
    const auto key = std::find(std::begin(kTallyKeyNames), std::end(kTallyKeyNames), words[5]);
    const auto named = io::parse_int64(words[7]);
    const auto alone = io::parse_int64(words[8]);
    if (key == std::end(kTallyKeyNames) || !named || !alone) return std::nullopt;
    return VerdictTally{static_cast<TallyKey>(key - std::begin(kTallyKeyNames)),
                        std::string(words[6]),
                        static_cast<int>(*named),
                        static_cast<int>(*alone)};
}

/// An append-only file with a header of two lines.
struct LineFile {
    std::string path;
    std::string head;

    /// Opens the file for appending. Calls `take` with the words of every complete line and keeps
    /// the lines for which it returns true.
    template <typename Take>
    [[nodiscard]] Result<io::AppendFile> open(const Take& take) const {
        std::string text;
        if (io::is_file(path)) {
            auto found = io::read_file(path);
            if (!found) return found.error();
            text = std::move(*found);
        }
        if (!text.empty() && !text.starts_with(head)) {
            return usage_error(
                fmt::format("{}: this file was made with other settings or by another version; "
                            "give a new --out folder, or remove the old folder",
                            path));
        }
        std::string kept = head;
        // A line is complete if its line end is in the file.
        const std::string_view lines =
            text.empty()
                ? std::string_view()
                : std::string_view(text).substr(head.size(), text.rfind('\n') + 1 - head.size());
        for (const std::string_view line : io::split(lines, "\n")) {
            if (take(io::split(line, ","))) kept += fmt::format("{}\n", line);
        }
        if (kept != text) {
            if (auto status = io::write_file(path, kept); !status) return status.error();
        }
        return io::AppendFile::resume(path);
    }
};

}  // namespace

Result<SuiteTable> SuiteTable::open(const std::string& folder, std::uint64_t conditions) {
    SuiteTable table;
    table.folder_ = folder;
    const std::string first =
        fmt::format("# surefoot {} eval suite, conditions {:016x}\n", SUREFOOT_VERSION, conditions);
    const LineFile cases{folder + "/cases.csv", first + cases_head()};
    const LineFile bins{
        folder + "/bins.csv",
        fmt::format("{}{},by,from,to,count,median_m,p90_m,p99_m,counts\n", first, kCaseHead)};
    const LineFile steps{
        folder + "/steps.csv",
        fmt::format("{}{},step,time_s,command,safe,clear_cut,seen,dangers,decision,"
                    "reasons\n",
                    first,
                    kCaseHead)};
    const LineFile verdicts{folder + "/verdicts.csv",
                            fmt::format("{}{},by,name,named,alone\n", first, kCaseHead)};
    auto cases_file = cases.open([&](const Words& words) {
        auto result = parse_case(words);
        return result && table.remember(std::move(*result));
    });
    if (!cases_file) return cases_file.error();
    const auto owner_of = [&](const Words& words) -> SuiteResult* {
        const auto which = words.size() > kKeyColumns ? parse_key(words) : std::nullopt;
        return which ? table.find(*which) : nullptr;
    };
    /// Reads the lines that belong to a known case and drops the others.
    const auto open_details = [&](const LineFile& file, const auto& parse, const auto& keep) {
        return file.open([&](const Words& words) {
            SuiteResult* owner = owner_of(words);
            const auto found = parse(words);
            if (owner != nullptr && found) keep(*owner, *found);
            return owner != nullptr && found;
        });
    };
    auto bins_file = open_details(bins, parse_bin, [](SuiteResult& owner, const SuiteBin& bin) {
        owner.bins.push_back(bin);
    });
    if (!bins_file) return bins_file.error();
    auto steps_file = open_details(steps, parse_step, [](SuiteResult& owner, const SuiteStep& s) {
        owner.steps.push_back(s);
    });
    if (!steps_file) return steps_file.error();
    auto verdicts_file =
        open_details(verdicts, parse_tally, [](SuiteResult& owner, const VerdictTally& tally) {
            owner.tallies.add(tally);
        });
    if (!verdicts_file) return verdicts_file.error();
    if (auto status = io::make_folder(folder + "/pictures"); !status) return status.error();
    table.cases_file_.emplace(std::move(*cases_file));
    table.bins_file_.emplace(std::move(*bins_file));
    table.steps_file_.emplace(std::move(*steps_file));
    table.verdicts_file_.emplace(std::move(*verdicts_file));
    return table;
}

bool SuiteTable::holds(const SuiteCase& which) const {
    return places_.contains(key_of(which));
}

SuiteResult* SuiteTable::find(const SuiteCase& which) {
    const auto place = places_.find(key_of(which));
    return place == places_.end() ? nullptr : &results_[place->second];
}

/// Adds a case. Returns false if the case is already known.
bool SuiteTable::remember(SuiteResult result) {
    if (!places_.emplace(key_of(result.which), results_.size()).second) return false;
    results_.push_back(std::move(result));
    return true;
}

Status SuiteTable::add(SuiteResult result) {
    SUREFOOT_ASSERT(!holds(result.which));
    if (auto status = keep_thumbnail(result); !status) return status;
    if (auto status = bins_file_->append(bin_lines(result)); !status) return status;
    if (auto status = steps_file_->append(step_lines(result)); !status) return status;
    if (auto status = verdicts_file_->append(verdict_lines(result)); !status) return status;
    if (auto status = cases_file_->append(case_line(result)); !status) return status;
    result.thumbnail.clear();
    [[maybe_unused]] const bool added = remember(std::move(result));
    return {};
}

Status SuiteTable::keep_thumbnail(const SuiteResult& result) {
    const bool another_is_worse =
        std::any_of(results_.begin(), results_.end(), [&](const SuiteResult& other) {
            return other.which.scene == result.which.scene && is_worse(other, result);
        });
    if (another_is_worse) return {};
    const std::string path = thumbnail_file(folder_, result.which.scene);
    if (result.thumbnail.empty()) return io::remove_file(path);
    return io::write_file(path, std::string(result.thumbnail.begin(), result.thumbnail.end()));
}

std::string thumbnail_file(const std::string& folder, const std::string& scene) {
    std::string name = scene;  // a path if the scene is a file
    std::replace_if(
        name.begin(), name.end(), [](char c) { return c == '/' || c == '#'; }, '_');
    return fmt::format("{}/pictures/{}.png", folder, name);
}

}  // namespace surefoot::app
