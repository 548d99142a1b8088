// SPDX-License-Identifier: Apache-2.0
// A verb declares its options with these classes. They hide CLI11, which adds ten seconds of
// compile time to each file that includes it. Only command_line.cpp includes CLI11.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "service/console/options.hpp"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace surefoot::app {

/// One declared option or positional argument. Each function adds a rule or a property and returns
/// the option, so that calls can be chained. A broken rule ends the call with kExitUsage.
class Option {
  public:
    explicit Option(CLI::Option* option) : option_(option) {}

    Option required() const;
    /// Sets the name of the value in --help, for example "M" or "FILE".
    Option value(const char* name) const;
    /// Accepts numbers from `least` to `most`, both included. NaN is refused.
    Option in(double least, double most) const;
    Option in(int least, int most) const;
    /// Accepts finite numbers above 0.
    Option positive() const;
    /// Accepts 0 and finite numbers above 0.
    Option not_negative() const;
    Option one_of(std::vector<std::string> names) const;
    /// Lets one argument contain several values, separated by commas.
    Option separated_by_commas() const;
    /// Limits each use of the option to one value, so that a positional argument may follow.
    Option one_value_each() const;
    Option show_default() const;
    Option needs(Option other) const;
    Option excludes(Option other) const;

  private:
    CLI::Option* option_;
};

/// Adds options to one verb. The referenced variables must live until the verb has run.
class Verb {
  public:
    explicit Verb(CLI::App* verb) : verb_(verb) {}

    // The name of an option begins with "--"; a name without dashes is a positional argument.
    Option option(const char* name, std::string& variable, const char* help) const;
    Option option(const char* name, int& variable, const char* help) const;
    Option option(const char* name, double& variable, const char* help) const;
    Option option(const char* name, std::uint64_t& variable, const char* help) const;
    Option option(const char* name, std::optional<int>& variable, const char* help) const;
    Option option(const char* name, std::optional<double>& variable, const char* help) const;
    Option option(const char* name, std::vector<std::string>& variable, const char* help) const;
    Option option(const char* name, std::vector<double>& variable, const char* help) const;
    Option flag(const char* name, bool& variable, const char* help) const;

  private:
    CLI::App* verb_;
};

/// settings: these are checked before the verb runs. own_settings: the verb checks its settings.
/// no_settings: --config, --set and --preset are checked; a warning says that they have no effect.
enum class Reads { settings, own_settings, no_settings };

/// A group of verbs: the program itself, or a verb that has verbs of its own, such as `eval`.
class VerbGroup {
  public:
    /// `exit_code` receives the exit code of the verb that the call names.
    VerbGroup(CLI::App* app, int& exit_code) : app_(app), exit_code_(&exit_code) {}

    /// Adds a verb that has verbs of its own. Every call must name one of these verbs.
    VerbGroup group(const char* name, const char* what, const char* example);

    /// Adds a verb that runs `handler`. Its options live as long as the command line. The tests run
    /// every example; several examples are separated by "\n  ".
    template <typename Options>
    std::pair<Verb, Options&> add(const char* name,
                                  const char* what,
                                  const char* example,
                                  int (*handler)(const Options&),
                                  Reads reads = Reads::settings) {
        auto options = std::make_shared<Options>();
        const Verb verb = declare(name, what, example, options->common, reads, [options, handler] {
            return handler(*options);
        });
        return {verb, *options};
    }

  private:
    Verb declare(const char* name,
                 const char* what,
                 const char* example,
                 CommonOptions& common,
                 Reads reads,
                 std::function<int()> run);

    CLI::App* app_;
    int* exit_code_;
};

/// Adds the options that control how recordings of other programs are read.
void add_reading(Verb verb, ReadingOptions& reading);
/// Adds the options of a source: reading rules, calibration, IMU, frame rate and length.
void add_source_options(Verb verb, SourceOptions& source);
/// Adds the option that skips frames that cannot be read.
void add_skip_broken(Verb verb, ReadingOptions& reading);

}  // namespace surefoot::app
