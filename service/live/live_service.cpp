// SPDX-License-Identifier: Apache-2.0
#include "service/live/live_service.hpp"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <string>
#include <system_error>
#include <thread>
#include <tuple>

#include "service/console/interrupt.hpp"
#include "service/console/log.hpp"
#include "service/console/source.hpp"
#include "service/gate_process/sockets/token_file.hpp"
#include "service/live/explain.hpp"
#include "service/live/machine_joints.hpp"
#include "service/live/page_telemetry.hpp"
#include "surefoot/core/checked_index.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/perception/fit_settings.hpp"

namespace surefoot::app {
namespace {

/// Length of the stored motion of a simulated walk. No frame shows an older motion.
constexpr double kRemembered_s = 10.0;
constexpr auto kLookEvery = std::chrono::milliseconds(20);

/// Sets the niceness of all threads except the first thread. The gate must have the highest
/// priority. The first thread comes next, because it restarts the gate, and the new gate inherits
/// its priority. Linux stores the priority per thread, so this function sets the niceness of every
/// existing thread. New threads inherit the niceness. The error contains the errno text of one
/// failed thread. A thread that has already ended is not an error.
Status be_nice(int niceness) {
    int refusal = 0;
    std::error_code error;
    for (const auto& task : std::filesystem::directory_iterator("/proc/self/task", error)) {
        const auto thread = static_cast<id_t>(std::stoul(task.path().filename().string()));
        if (thread == static_cast<id_t>(::getpid())) continue;
        if (::setpriority(PRIO_PROCESS, thread, niceness) != 0 && errno != ESRCH) refusal = errno;
    }
    if (refusal == 0) return {};
    return usage_error(
        fmt::format("service.niceness: the system refuses the value {}: {}; to use this value, "
                    "restart serve with --nice {}",
                    niceness,
                    std::strerror(refusal),
                    niceness));
}

std::vector<std::string> gate_arguments(const ServeOptions& options, const std::string& channel) {
    std::vector<std::string> words{"--snapshots",
                                   channel,
                                   "--machine",
                                   options.machine,
                                   "--port",
                                   std::to_string(options.port),
                                   "--bind",
                                   options.bind_address};
    const auto add = [&words](const char* option, const std::string& value) {
        if (value.empty()) return;
        words.emplace_back(option);
        words.push_back(value);
    };
    add("--audit", options.audit_dir);
    add("--token-file", options.token_file);
    add("--guests", options.guests);
    add("--certificate", options.certificate_file);
    add("--key", options.key_file);
    add("--insecure", options.insecure);
    for (const std::string& origin : options.origins) add("--origin", origin);
    if (options.assured) words.emplace_back("--assured");
    if (options.max_rate_hz > 0) add("--max-rate", std::to_string(options.max_rate_hz));
    if (options.audit_mb > 0) add("--audit-mb", std::to_string(options.audit_mb));
    return words;
}

Result<std::unique_ptr<camera::FrameSource>> open(const ServeOptions& options,
                                                  const Settings& settings,
                                                  Executor& executor,
                                                  int first_frame = 0) {
    SourceRequest request = request_of(options, options.common, settings);
    request.first_frame = first_frame;
    request.sim.commanded = options.joystick || !options.walk.empty();
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

}  // namespace

/// With --json stdout is reserved for the answer, so the address goes to stderr.
void LiveService::tell_where(const GateChild& gate) {
    std::FILE* const out = options_.common.json ? stderr : stdout;
    fmt::print(out,
               "the gate listens on {}://{}:{}\n",
               options_.certificate_file.empty() ? "ws" : "wss",
               options_.bind_address,
               gate.port());
    std::fflush(out);
    hello_.gate_port = gate.port();
    page_->introduce(hello_, machine_);
}

void LiveService::look_after(GateChild& gate, MapChannel& channel) {
    channel.look_after(steady_now_ns());
    const auto started = gate.watch(steady_now_ns());
    if (!started) log_error(started.error().message);
    if (!started || !*started) return;
    log_warning(
        fmt::format("the gate process ended and was restarted ({} restarts so far); no movement is "
                    "allowed until the gate is ready",
                    gate.restarts()));
    tell_where(gate);
}

/// Applies the operator attestation to the pictures from the first map on, as the gate does.
void LiveService::remember_word(const LiveSession& session) {
    if (session.published() == 0) return;
    if (!word_given_) {
        word_given_ = true;
        std::ignore =
            word_.attest(machine_->machine,
                         session.last(),
                         saturated_integer<std::int64_t>(1e4 * options_.attestation_radius_m),
                         steady_now_ns());
    }
    word_.observe(session.last(), steady_now_ns());
}

void LiveService::draw(const AskedStep& step, const grid::MapSnapshot& map) {
    if (options_.out_dir.empty() || !grid::is_intact(map)) return;
    gate::Query query = gate::query_at_body(step.command, map);
    query.attested = word_.area();
    const gate::GateHealth ready{gate::GateState::ready, {}};
    const gate::Verdict verdict =
        gate::decide(machine_->machine, query, map, ready, map.frame_time_ns);
    const std::string file = io::join_path(
        options_.out_dir, fmt::format("{:03}_movement_{}.png", steps_.size(), step.command));
    const auto drawn = write_explanation(
        file, machine_->machine, query, map, verdict, step.moved ? "moved" : step.text);
    if (!drawn) log_error(drawn.error().message);
}

void LiveService::follow_walk(sim::SceneSource& scene, const LiveSession& session) {
    remember_word(session);
    walk_->next_frame_begins(scene.now_s() + 1.0 / settings_.sim.rate_hz);
    scene.commanded()->forget_before(scene.now_s() - kRemembered_s);
    const auto news = walk_->news();
    print_news(news, options_.common.json ? stderr : stdout);
    for (const AskedStep& step : news) {
        steps_.push_back(step);
        draw(step, session.last());
    }
}

/// Applies the playback state that the pages set: waits while the recording is paused, and sets the
/// speed. Returns false if a page wants to jump to another frame.
bool LiveService::follow_pages(LiveSession& session, const gate_process::SnapshotWriter& writer) {
    page::Playback& playback = page_->controls().playback;
    auto state = playback.state();
    if (!state) {
        const double wanted = scene_speed_;
        if (wanted != speed_) session.pace(wanted);
        speed_ = wanted;
        return true;
    }
    const bool stood = state->paused;
    while (state->paused && !playback.jump_wanted() && !interrupted() && !writer.restart_wanted()) {
        std::this_thread::sleep_for(kLookEvery);
        state = playback.state();
    }
    if (stood || state->speed != speed_) session.pace(state->speed);
    speed_ = state->speed;
    return !playback.jump_wanted();
}

/// Processes the source from its next frame on with a new pipeline, which has a new map and a new
/// odom frame.
Result<LiveSession::End> LiveService::perceive_anew(camera::FrameSource& source,
                                                    gate_process::SnapshotWriter& writer) {
    auto* const scene = dynamic_cast<sim::SceneSource*>(&source);
    auto pipeline = pipeline::Pipeline::make(
        settings_.pipeline, mounted_rig(source.rig(), machine_), executor_, steady_now_ns);
    if (!pipeline) return pipeline.error();
    camera::FrameSource* frames = &source;
    std::optional<RecordedSource> recorded;
    if (recorder_) frames = &recorded.emplace(source, *recorder_);
    LiveSession session(*pipeline, *frames, writer, hash_of(settings_));
    std::optional<PageTelemetry> page;
    if (page_->feed() != nullptr)
        page.emplace(
            *page_->feed(), source.info().path, model_ ? joints_of(source, *model_) : JointsAt{});
    const auto before_frame = [&] {
        if (walk_) follow_walk(*scene, session);
        return !(walk_ && walk_->is_over()) && follow_pages(session, writer);
    };
    const auto after_frame = [&](const FrameReport& report, std::int64_t map_time_ns) {
        if (page) page->tell(*pipeline, report, session.last(), map_time_ns, steady_now_ns());
        page_->controls().playback.at(report.index);
    };
    auto end = session.run(speed_, before_frame, after_frame);
    const bool goes_on = end && (*end == LiveSession::End::restart_wanted ||
                                 page_->controls().playback.jump_wanted());
    if (page && goes_on) page->tell_new_beginning();
    if (page && !goes_on) page->tell_the_end(*pipeline);
    return end;
}

/// Returns the frame to continue from. At the end of a recording, waits until a page jumps to a
/// frame.
std::optional<int> LiveService::next_jump(LiveSession::End end) {
    page::Playback& playback = page_->controls().playback;
    if (end == LiveSession::End::source_ended && playback.state() && !options_.once) {
        while (!playback.jump_wanted() && !interrupted()) std::this_thread::sleep_for(kLookEvery);
    }
    return playback.take_jump();
}

Status LiveService::perceive(std::unique_ptr<camera::FrameSource> source,
                             gate_process::SnapshotWriter& writer) {
    while (true) {
        const auto end = perceive_anew(*source, writer);
        if (!end) return end.error();
        if (*end == LiveSession::End::restart_wanted) {
            log_warning("the gate was re-armed, so the map and the odom frame start again");
        } else {
            const auto frame = next_jump(*end);
            if (!frame) return {};
            auto again = open(options_, settings_, executor_, *frame);
            if (!again) return again.error();
            source = std::move(again).value();
        }
        writer.begin_anew();
    }
}

Status LiveService::perceive_beside(GateChild& gate,
                                    std::unique_ptr<camera::FrameSource> source,
                                    MapChannel& channel) {
    Status perceived;
    std::atomic<bool> ended{false};
    std::thread perception([&] {
        if (options_.niceness != 0) std::ignore = be_nice(options_.niceness);
        perceived = perceive(std::move(source), channel.writer);
        ended = true;
    });
    while (!ended) {
        look_after(gate, channel);
        std::this_thread::sleep_for(kLookEvery);
    }
    perception.join();
    return perceived;
}

/// Sends the description of the source and the available controls to the pages.
Status LiveService::introduce(const camera::FrameSource& source,
                              const gate_process::Access& access,
                              std::uint16_t gate_port) {
    auto page = PageService::start(options_, access);
    if (!page) return page.error();
    page_ = std::move(page).value();
    const bool is_scene = dynamic_cast<const sim::SceneSource*>(&source) != nullptr;
    hello_ = hello_of(source,
                      mounted_rig(source.rig(), machine_),
                      machine_,
                      model_,
                      gate_port,
                      is_scene ? settings_.sim.rate_hz : 0.0);
    hello_.can_steer = options_.joystick;
    speed_ = options_.speed.value_or(is_scene && !options_.joystick ? 0.0 : 1.0);
    if (!is_scene && !source.info().steady_stamps)
        page_->controls().playback.offer({0, source.info().frames.value_or(0), false, speed_});
    if (page_->feed() == nullptr) return {};
    offer_settings(is_scene);
    offer_recording(source);
    return {};
}

/// Offers the settings to pages. Pages see every setting of the run and can change the settings of
/// the service.
void LiveService::offer_settings(bool is_scene) {
    ServiceConfig first;
    first.speed = speed_;
    first.niceness = options_.niceness;
    scene_speed_ = speed_;
    niceness_ = options_.niceness;
    service_settings_.emplace(
        first, is_scene, [this](const ServiceConfig& wanted) { return apply(wanted); });
    page_->controls().settings.offer(
        service_settings_->for_pages(settings_),
        [this](const page::SettingWish& wish) { return change(wish); });
}

void LiveService::offer_recording(const camera::FrameSource& source) {
    FrameRecorderConfig config;
    config.record_dir = options_.record_dir;
    recorder_.emplace(config, source.rig(), source.info(), page_->controls().recording);
}

Status LiveService::apply(const ServiceConfig& wanted) {
    if (wanted.niceness != niceness_) {
        if (auto nice = be_nice(wanted.niceness); !nice) return nice;
        niceness_ = wanted.niceness;
    }
    page::PageRates& rates = page_->feed()->rates;
    rates.map_hz = wanted.map_hz;
    rates.image_hz = wanted.image_hz;
    rates.layer_hz = wanted.layer_hz;
    scene_speed_ = wanted.speed;
    return {};
}

Result<std::string> LiveService::change(const page::SettingWish& wish) {
    auto changed = service_settings_->change(wish);
    if (changed) {
        log_info(
            fmt::format("{} is now {}, because a page changed this setting", wish.key, *changed));
    } else {
        log_warning(fmt::format("a page cannot change a setting: {}", changed.error().message));
    }
    return changed;
}

/// Starts the steered walk if --walk or --joystick was given.
Status LiveService::steer(camera::FrameSource& source,
                          const std::string& rider_token,
                          std::uint16_t gate_port) {
    if (options_.walk.empty() && !options_.joystick) return {};
    if (!options_.walk.empty() && options_.joystick)
        return usage_error(
            "--walk and --joystick cannot work together; give --walk or --joystick, not both");
    if (options_.joystick && options_.no_page)
        return usage_error("--joystick needs the page, on which the joystick is; remove --no-page");
    auto* const scene = dynamic_cast<sim::SceneSource*>(&source);
    if (scene == nullptr || !scene->commanded())
        return usage_error(
            "--walk and --joystick can steer only a simulated scene; give a source sim:SCENE, or "
            "remove --walk and --joystick");
    std::unique_ptr<Walker> walker;
    if (options_.joystick) {
        walker = page_walker(page_->controls().steering);
    } else {
        auto codes = parse_walk(options_.walk);
        if (!codes) return codes.error();
        walker = scripted_walker(std::move(codes).value());
    }
    walk_ = std::make_unique<SteeredWalk>(
        std::move(walker), gate_port, rider_token, scene->commanded());
    return {};
}

Status LiveService::run() {
    auto source = open(options_, settings_, executor_);
    if (!source) return source.error();
    fit_settings((*source)->rig(), machine_, settings_);
    const auto loaded =
        gate_process::load_access(options_.token_file, options_.guests, options_.bind_address);
    if (!loaded) return loaded.error();
    fmt::print(stderr, "{}", loaded->news);
    auto key = options_.channel_key.empty() ? gate_process::new_checksum_key()
                                            : gate_process::read_checksum_key(options_.channel_key);
    if (!key) return key.error();
    const std::string path = channel_path(options_.channel);
    auto writer = gate_process::SnapshotWriter::create({path, *key});
    if (!writer) return writer.error();
    MapChannel channel(std::move(*writer));
    GateChild::Start how{gate_arguments(options_, path), {}, *key};
    if (options_.attestation_radius_m > 0.0)
        how.first_arguments = {"--attest", fmt::format("{}", options_.attestation_radius_m)};
    auto gate = GateChild::start(std::move(how));
    if (!gate) return gate.error();
    if (auto introduced = introduce(**source, loaded->access, gate->port()); !introduced)
        return introduced;
    tell_where(*gate);
    if (page_->port() != 0) {
        std::FILE* const out = options_.common.json ? stderr : stdout;
        const char* const s = options_.certificate_file.empty() ? "" : "s";
        fmt::print(
            out, "the page is at http{}://{}:{}/\n", s, options_.bind_address, page_->port());
        fmt::print(
            out, "Foxglove connects to ws{}://{}:{}/\n", s, options_.bind_address, page_->port());
        std::fflush(out);
    }
    watch_for_interrupts();
    if (auto steered = steer(**source, loaded->access.rider, gate->port()); !steered)
        return steered;
    Status perceived = perceive_beside(*gate, std::move(source).value(), channel);
    walk_.reset();
    if (!perceived) return perceived;
    // Without new frames the gate answers that the frames are old.
    while (!options_.once && !interrupted()) {
        look_after(*gate, channel);
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    return {};
}

}  // namespace surefoot::app
