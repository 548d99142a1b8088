// SPDX-License-Identifier: Apache-2.0
// Only this file includes CLI11, because CLI11 adds ten seconds of compile time to a translation
// unit.
#include "cli/command_line.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/core/utility.hpp>
#include <string_view>

#include "cli/json/verdict_answers.hpp"
#include "cli/verb.hpp"
#include "cli/verbs/verbs.hpp"
#include "service/console/log.hpp"
#include "service/console/option_settings.hpp"
#include "surefoot/core/nearest_names.hpp"
#include "surefoot/io/settings/renamed_keys.hpp"

namespace surefoot::app {
namespace {

/// Refuses numbers that are not finite. The range checks of CLI11 are not enough: CLI::Range
/// accepts NaN, and CLI::PositiveNumber accepts infinity.
CLI::Validator finite_number() {
    return {[](const std::string& text) {
                double value = 0.0;
                const bool is_number = CLI::detail::lexical_cast(text, value);
                return is_number && !std::isfinite(value)
                           ? "Value " + text + " is not a finite number"
                           : std::string();
            },
            ""};
}

/// Adds a subcommand and shows an example below its help text.
CLI::App* add_subcommand(CLI::App& app, const char* name, const char* what, const char* example) {
    CLI::App* verb = app.add_subcommand(name, what);
    verb->footer(std::string("Example:\n  ") + example);
    return verb;
}

void add_common(Verb verb, CommonOptions& common) {
    verb.option("--config",
                common.config_file,
                "read settings from this YAML file; an unknown key in the file is an error")
        .value("FILE");
    verb.option("--set",
                common.settings,
                "set one setting, for example elevation.length_m=8; repeat the option for more "
                "settings")
        .value("KEY=VALUE")
        .one_value_each();
    verb.option("--preset",
                common.preset,
                "named set of traversability settings: rex_zed, rex_demo_stairs, laser or ethz")
        .value("NAME");
    verb.flag("--json", common.json, "print the result as one JSON object on stdout");
    verb.option("--threads",
                common.threads,
                "number of threads, 0 = all cores (default 0); the results do not depend on this "
                "number")
        .in(0, 256);
    verb.option(
        "--seed", common.seed, "seed of the random numbers of simulated scenes (default 1)");
}

int check_settings(const CommonOptions& common, const std::string& verb, Reads reads) {
    if (reads == Reads::own_settings) return kExitOk;
    if (const auto settings = load_settings(common); !settings) return report(settings.error());
    const bool given =
        !common.config_file.empty() || !common.preset.empty() || !common.settings.empty();
    if (reads == Reads::no_settings && given)
        log_warning(verb +
                    ": this verb reads no settings; --config, --set and --preset have no effect");
    return kExitOk;
}

/// Returns the innermost verb of this call, for example `maps` for `surefoot eval maps`.
const CLI::App& verb_of_call(const CLI::App& app) {
    const auto verbs = app.get_subcommands();
    return verbs.empty() ? app : verb_of_call(*verbs.front());
}

/// Describes a wrong call in one sentence. The first unparsed word is a misspelled option if it
/// starts with '-', otherwise a misspelled verb. For all other errors the function returns the text
/// of CLI11.
std::string sentence_of(const CLI::App& app, const CLI::ParseError& error) {
    const CLI::App& verb = verb_of_call(app);
    std::vector<std::string> words = app.remaining(true);
    std::erase(words, "--json");  // in `eval --json` the mistake is the missing verb, not --json
    if (words.empty()) return error.what();
    const std::string word = words.front().substr(0, words.front().find('='));
    std::vector<std::string> names;
    if (word.starts_with('-')) {
        for (const CLI::Option* option : verb.get_options()) {
            for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
        }
        return fmt::format("there is no option {}{}", word, did_you_mean(word, names));
    }
    for (const CLI::App* sub : verb.get_subcommands([](const CLI::App*) { return true; }))
        names.push_back(sub->get_name());
    if (names.empty()) return error.what();
    return fmt::format("there is no verb '{}'{}", word, did_you_mean(word, names));
}

/// Handles the end of parsing. --help and --version succeed; every other case is a wrong call with
/// a one-sentence error. A wrong call of `gate` must not look like a permission, so the function
/// returns kExitUsage.
int end_of_parsing(const CLI::App& app, const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    const std::string name = verb_of_call(app).get_name();
    const std::string verb = name.empty() ? "" : name + ": ";
    log_error(verb + sentence_of(app, error));
    fmt::print(stderr, "Run with --help to see the verbs and options.\n");
    return kExitUsage;
}

/// With --json every call prints exactly one object. If the verb failed without printing a result,
/// this function prints the error. For `gate` it prints a verdict, so that a missing verdict cannot
/// be read as permission.
int answer_failure(const CLI::App& app, bool json, int exit_code) {
    if (!json || exit_code == kExitOk || answered()) return exit_code;
    const bool asks_gate = app.got_subcommand("gate");
    print_answer(asks_gate ? verdict_json(gate::Verdict{}, first_error(), {})
                           : failure_json(first_error(), exit_code));
    return exit_code;
}

/// An option that version 0.2 renamed. Version 0.3 will refuse the old name (docs/migration.md).
struct RenamedOption {
    std::string_view verb;
    std::string_view old_name;
    std::string_view new_name;
};
constexpr std::array kRenamedOptions{
    RenamedOption{"gate", "--vouch", "--attest"},
    RenamedOption{"serve", "--vouch", "--attest"},
    RenamedOption{"eval suite", "--carriers", "--motion-models"},
    RenamedOption{"eval suite", "--thesis", "--lange2016"},
    RenamedOption{"calibrate mono", "--eye", "--camera"},
};

/// The words before the first option: the verb and the arguments that follow it directly.
std::string first_words(const std::vector<std::string>& words) {
    std::string first;
    for (const std::string& word : words) {
        if (word.starts_with('-')) break;
        first += word + " ";
    }
    return first;
}

/// Returns the words of the call with the current option names. Warns about each old name.
std::vector<std::string> words_of_call(int argc, char** argv) {
    std::vector<std::string> words(argv + 1, argv + argc);
    const std::string first = first_words(words);
    for (std::string& word : words) {
        const std::size_t end = std::min(word.find('='), word.size());
        for (const auto& [verb, old_name, new_name] : kRenamedOptions) {
            if (!first.starts_with(fmt::format("{} ", verb)) || word.substr(0, end) != old_name)
                continue;
            log_warning(io::renamed_note(old_name, new_name));
            word.replace(0, end, new_name);
            break;
        }
    }
    return words;
}

bool wants_json(int argc, char** argv) {
    return std::any_of(
        argv, argv + argc, [](const char* word) { return std::string_view(word) == "--json"; });
}

}  // namespace

Option Option::required() const {
    option_->required();
    return *this;
}
Option Option::value(const char* name) const {
    option_->type_name(name);
    return *this;
}
Option Option::in(double least, double most) const {
    option_->check(CLI::Range(least, most) & finite_number());
    return *this;
}
Option Option::in(int least, int most) const {
    option_->check(CLI::Range(least, most));
    return *this;
}
Option Option::positive() const {
    option_->check(CLI::PositiveNumber & finite_number());
    return *this;
}
Option Option::not_negative() const {
    option_->check(CLI::NonNegativeNumber & finite_number());
    return *this;
}
Option Option::one_of(std::vector<std::string> names) const {
    option_->check(CLI::IsMember(std::move(names)));
    return *this;
}
Option Option::separated_by_commas() const {
    option_->delimiter(',');
    return *this;
}
Option Option::one_value_each() const {
    option_->allow_extra_args(false);
    return *this;
}
Option Option::show_default() const {
    option_->capture_default_str();
    return *this;
}
Option Option::needs(Option other) const {
    option_->needs(other.option_);
    return *this;
}
Option Option::excludes(Option other) const {
    option_->excludes(other.option_);
    return *this;
}

Option Verb::option(const char* name, std::string& variable, const char* help) const {
    return Option(verb_->add_option(name, variable, help));
}
Option Verb::option(const char* name, int& variable, const char* help) const {
    return Option(verb_->add_option(name, variable, help));
}
Option Verb::option(const char* name, double& variable, const char* help) const {
    return Option(verb_->add_option(name, variable, help));
}
Option Verb::option(const char* name, std::uint64_t& variable, const char* help) const {
    return Option(verb_->add_option(name, variable, help));
}
Option Verb::option(const char* name, std::optional<int>& variable, const char* help) const {
    return Option(verb_->add_option(name, variable, help));
}
Option Verb::option(const char* name, std::optional<double>& variable, const char* help) const {
    return Option(verb_->add_option(name, variable, help));
}
Option Verb::option(const char* name, std::vector<std::string>& variable, const char* help) const {
    return Option(verb_->add_option(name, variable, help));
}
Option Verb::option(const char* name, std::vector<double>& variable, const char* help) const {
    return Option(verb_->add_option(name, variable, help));
}
Option Verb::flag(const char* name, bool& variable, const char* help) const {
    return Option(verb_->add_flag(name, variable, help));
}

VerbGroup VerbGroup::group(const char* name, const char* what, const char* example) {
    CLI::App* verb = add_subcommand(*app_, name, what, example);
    verb->require_subcommand(1);
    return {verb, *exit_code_};
}

Verb VerbGroup::declare(const char* name,
                        const char* what,
                        const char* example,
                        CommonOptions& common,
                        Reads reads,
                        std::function<int()> run) {
    CLI::App* added = add_subcommand(*app_, name, what, example);
    const Verb verb(added);
    add_common(verb, common);
    added->callback(
        [&common, &exit_code = *exit_code_, reads, name = std::string(name), run = std::move(run)] {
            exit_code = check_settings(common, name, reads);
            if (exit_code == kExitOk) exit_code = run();
        });
    return verb;
}

void add_reading(Verb verb, ReadingOptions& reading) {
    verb.option("--pair-tolerance",
                reading.pair_tolerance_s,
                "largest time difference between the two images of a frame, in s (default: 1/5 of "
                "the time between two frames; 0.02 for TUM RGB-D folders)")
        .value("S")
        .in(0.0, 10.0);
    verb.option("--depth-factor",
                reading.depth_codes_per_m,
                "pixel value of an RGB-D depth image that means a distance of 1 m (5000 in TUM "
                "folders, 1000 if the values are mm)")
        .value("N")
        .in(1.0, 1e6);
    verb.option("--image-bits",
                reading.image_bits,
                "number of used bits in a 16-bit camera image; Surefoot reads the upper 8 of the "
                "used bits")
        .value("N")
        .in(9, 16);
}
void add_skip_broken(Verb verb, ReadingOptions& reading) {
    verb.flag("--skip-broken",
              reading.skip_broken,
              "skip and count the frames of a recording that cannot be read; without this option "
              "the verb stops at the first such frame");
}

void add_source_options(Verb verb, SourceOptions& source) {
    verb.option("--rig",
                source.rig_file,
                "calibration file; it replaces the calibration of the source. For a simulated "
                "scene also the name of a built-in rig, for example zed_vga")
        .value("FILE|NAME");
    verb.option("--imu",
                source.imu_file,
                "IMU samples: an EuRoC csv file, or a FIFO that delivers the rows of such a file. "
                "Their time stamps must use the clock of the frames (CLOCK_MONOTONIC for a live "
                "camera)")
        .value("FILE");
    verb.option("--rate", source.rate_hz, "frame rate of a source without time stamps, in Hz")
        .value("HZ")
        .in(0.01, 1000.0);
    verb.option("--max-frames", source.max_frames, "stop after this number of frames").positive();
    add_reading(verb, source.reading);
    add_skip_broken(verb, source.reading);
}

int run_command_line(int argc, char** argv) {
    cv::setNumThreads(1);  // only the executor creates threads
    CLI::App app{
        "Surefoot answers: is it safe to step there? It computes depth, odometry, an elevation "
        "map, stairs and the verdict of the gate for a stereo camera on a walking machine"};
    app.set_version_flag("--version", SUREFOOT_VERSION);
    app.require_subcommand(1);
    app.footer("Run 'surefoot VERB --help' to see the options of one verb and an example.");

    int exit_code = kExitOk;
    add_all_verbs(VerbGroup(&app, exit_code));
    const bool json = wants_json(argc, argv);
    try {
        std::vector<std::string> words = words_of_call(argc, argv);
        // CLI11 reads the words from the last to the first.
        std::reverse(words.begin(), words.end());
        app.name(argv[0]);
        app.parse(std::move(words));
    } catch (const CLI::ParseError& error) {
        exit_code = end_of_parsing(app, error);
    } catch (const std::exception& error) {
        // fmt throws this error if a write to stdout fails.
        const bool is_output = std::ferror(stdout) != 0;
        log_error(std::string(is_output ? "stdout: " : "internal error: ") + error.what());
        exit_code = kExitFailed;
    }
    exit_code = answer_failure(app, json, exit_code);
    if (const Status written = close_stdout(); !written && exit_code == kExitOk) {
        log_error(written.error().message);
        return app.got_subcommand("gate") ? kExitGateError : kExitFailed;
    }
    return exit_code;
}

}  // namespace surefoot::app
