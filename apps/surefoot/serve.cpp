// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <thread>
#include <tuple>

#include "apps/surefoot/explain.hpp"
#include "apps/surefoot/fit_settings.hpp"
#include "apps/surefoot/gate_child.hpp"
#include "apps/surefoot/interrupt.hpp"
#include "apps/surefoot/json_output.hpp"
#include "apps/surefoot/live_session.hpp"
#include "apps/surefoot/log.hpp"
#include "apps/surefoot/source.hpp"
#include "apps/surefoot/steered_walk.hpp"
#include "apps/surefoot/verbs.hpp"
#include "io/file.hpp"
#include "sim/scene_source.hpp"
#include "surefoot/gate/vouching.hpp"

namespace surefoot::app {
namespace {

/// A name in shared memory that is free again when the program ends.
class ChannelFile {
  public:
    explicit ChannelFile(std::string path) : path_(std::move(path)) {}
    ~ChannelFile() { ::unlink(path_.c_str()); }
    ChannelFile(const ChannelFile&) = delete;
    ChannelFile& operator=(const ChannelFile&) = delete;
    [[nodiscard]] const std::string& path() const noexcept { return path_; }

  private:
    std::string path_;
};

std::string channel_path(const ServeOptions& options) {
    if (!options.channel.empty()) return options.channel;
    return fmt::format("/dev/shm/surefoot-{}-{}.channel", ::getuid(), ::getpid());
}

std::vector<std::string> gate_arguments(const ServeOptions& options, const std::string& channel) {
    std::vector<std::string> words{"--snapshots",
                                   channel,
                                   "--machine",
                                   options.machine,
                                   "--port",
                                   std::to_string(options.port),
                                   "--bind",
                                   options.bind_address,
                                   "--orphan-ends"};
    const auto add = [&words](const char* option, const std::string& value) {
        if (value.empty()) return;
        words.emplace_back(option);
        words.push_back(value);
    };
    add("--audit", options.audit_dir);
    add("--token-file", options.token_file);
    if (options.assured) words.emplace_back("--assured");
    return words;
}

Result<std::unique_ptr<camera::FrameSource>> open(const ServeOptions& options,
                                                  const Settings& settings,
                                                  Executor& executor) {
    SourceRequest request{options.source,
                          options.rig_file,
                          options.rate_hz,
                          options.max_frames,
                          options.common.seed,
                          settings.sim,
                          settings.live,
                          {}};
    request.sim.commanded = !options.walk.empty();
    return open_source(request, executor);
}

void print_news(const std::vector<AskedStep>& news, std::FILE* out) {
    for (const AskedStep& step : news) {
        fmt::print(out,
                   "movement {}: {}: {}\n",
                   step.command,
                   step.moved ? "moved" : step.verdict,
                   step.text);
    }
    std::fflush(out);
}

/// Perception, the gate process beside it, and perhaps somebody who walks.
class Service {
  public:
    Service(const ServeOptions& options,
            const Settings& settings,
            const std::optional<io::MachineFile>& machine,
            Executor& executor)
        : options_(options), settings_(settings), machine_(machine), executor_(executor) {}

    Status run();
    [[nodiscard]] const std::vector<AskedStep>& steps() const noexcept { return steps_; }

  private:
    Status perceive(camera::FrameSource& source, wire::SnapshotWriter& writer, GateChild& gate);
    void tell_where(const GateChild& gate) const;
    void look_after(GateChild& gate);
    void remember_word(const LiveSession& session);
    void draw(const AskedStep& step, const grid::MapSnapshot& map);

    const ServeOptions& options_;
    const Settings& settings_;
    const std::optional<io::MachineFile>& machine_;
    Executor& executor_;
    std::unique_ptr<SteeredWalk> walk_;
    std::vector<AskedStep> steps_;
    gate::Vouching word_;
    bool word_given_ = false;
};

/// With --json the answer has stdout for itself.
void Service::tell_where(const GateChild& gate) const {
    if (gate.port() == 0) return;
    std::FILE* const out = options_.common.json ? stderr : stdout;
    fmt::print(out, "the gate listens on ws://{}:{}\n", options_.bind_address, gate.port());
    std::fflush(out);
}

void Service::look_after(GateChild& gate) {
    if (gate.watch(steady_now_ns())) return;
    log_warning(fmt::format(
        "the gate process ended and was started again ({} times now); nothing is allowed until it "
        "is ready",
        gate.restarts()));
    tell_where(gate);
}

/// The gate has the operator's word from the first map on; so have the pictures.
void Service::remember_word(const LiveSession& session) {
    if (session.published() == 0) return;
    if (!word_given_) {
        word_given_ = true;
        std::ignore = word_.vouch(machine_->machine,
                                  session.last(),
                                  static_cast<std::int64_t>(1e4 * options_.vouch_radius_m));
    }
    word_.observe(session.last());
}

void Service::draw(const AskedStep& step, const grid::MapSnapshot& map) {
    if (options_.out_dir.empty() || !grid::is_intact(map)) return;
    gate::Query query = gate::query_at_body(step.command, map);
    query.vouched = word_.area();
    const gate::GateHealth ready{gate::GateState::ready, {}};
    const gate::Verdict verdict =
        gate::decide(machine_->machine, query, map, ready, map.frame_time_ns);
    const std::string file = io::join_path(
        options_.out_dir, fmt::format("{:03}_movement_{}.png", steps_.size(), step.command));
    const auto drawn = write_explanation(
        file, machine_->machine, query, map, verdict, step.moved ? "moved" : step.text);
    if (!drawn) log_error(drawn.error().message);
}

Status Service::perceive(camera::FrameSource& source,
                         wire::SnapshotWriter& writer,
                         GateChild& gate) {
    auto* const scene = dynamic_cast<sim::SceneSource*>(&source);
    const camera::StereoRig rig = mounted_rig(source.rig(), machine_);
    while (true) {
        auto pipeline = pipeline::Pipeline::make(settings_.pipeline, rig, executor_, steady_now_ns);
        if (!pipeline) return pipeline.error();
        LiveSession session(*pipeline, source, writer, hash_of(settings_));
        const double speed = scene != nullptr ? 0.0 : options_.speed;
        const auto end = session.run(speed, [&] {
            look_after(gate);
            if (!walk_) return true;
            remember_word(session);
            walk_->next_frame_begins(scene->now_s() + 1.0 / settings_.sim.rate_hz);
            const auto news = walk_->news();
            print_news(news, options_.common.json ? stderr : stdout);
            for (const AskedStep& step : news) {
                steps_.push_back(step);
                draw(step, session.last());
            }
            return !walk_->is_over();
        });
        if (!end) return end.error();
        if (*end != LiveSession::End::restart_wanted) return {};
        log_warning("the gate was re-armed: map and odom begin anew");
        writer.begin_anew();
    }
}

Status Service::run() {
    auto source = open(options_, settings_, executor_);
    if (!source) return source.error();
    const ChannelFile channel(channel_path(options_));
    auto writer = wire::SnapshotWriter::create(channel.path());
    if (!writer) return writer.error();
    std::vector<std::string> first;
    if (options_.vouch_radius_m > 0.0)
        first = {"--vouch", fmt::format("{}", options_.vouch_radius_m)};
    auto gate = GateChild::start(gate_arguments(options_, channel.path()), first);
    if (!gate) return gate.error();
    tell_where(*gate);
    ::setpriority(PRIO_PROCESS, 0, 10);  // the gate's answers come first
    watch_for_interrupts();
    if (!options_.walk.empty()) {
        auto* const scene = dynamic_cast<sim::SceneSource*>(source->get());
        if (scene == nullptr || !scene->commanded())
            return usage_error("--walk steers a simulated scene (sim:SCENE), no other source");
        auto codes = parse_walk(options_.walk);
        if (!codes) return codes.error();
        walk_ = std::make_unique<SteeredWalk>(
            std::move(codes).value(), gate->port(), scene->commanded());
    }
    Status perceived = perceive(**source, *writer, *gate);
    walk_.reset();
    if (!perceived) return perceived;
    while (!options_.once && !interrupted()) {  // whoever asks now hears that the frames are old
        look_after(*gate);
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    return {};
}

}  // namespace

int serve(const ServeOptions& options) {
    auto settings = load_settings(options.common);
    if (!settings) return report(settings.error());
    const auto machine = load_machine(options.machine);
    if (!machine) return report(machine.error());
    if (!options.out_dir.empty()) {
        if (auto made = io::make_folder(options.out_dir); !made) return report(made.error());
    }
    const auto executor = make_executor(options.common);
    fit_settings({}, *machine, *settings);
    Service service(options, *settings, *machine, *executor);
    const Status served = service.run();
    if (options.common.json) print_answer(serve_json(service.steps()));
    return served ? kExitOk : report(served.error());
}

}  // namespace surefoot::app
