// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>
#include <thread>
#include <tuple>

#include "cli/json/service_answers.hpp"
#include "cli/verbs/verbs.hpp"
#include "service/console/interrupt.hpp"
#include "service/console/log.hpp"
#include "service/console/source.hpp"
#include "service/gate_process/sockets/token_file.hpp"
#include "service/live/explain.hpp"
#include "service/live/find_model.hpp"
#include "service/live/frame_recorder.hpp"
#include "service/live/gate_child.hpp"
#include "service/live/live_session.hpp"
#include "service/live/machine_joints.hpp"
#include "service/live/page_telemetry.hpp"
#include "service/live/service_settings.hpp"
#include "service/live/steered_walk.hpp"
#include "service/page/page_server.hpp"
#include "surefoot/core/checked_index.hpp"
#include "surefoot/gate/attestation.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/perception/fit_settings.hpp"
#include "surefoot/sim/scene_source.hpp"

namespace surefoot::app {
namespace {

struct ServeOptions {
    CommonOptions common;
    ReadingOptions reading;
    std::string source;
    std::string rig_file;
    std::string machine = "rex";
    /// File or built-in name; empty = the built-in model with the name of the machine.
    std::string model;
    double rate_hz = 0.0;
    int max_frames = 0;
    /// Playback speed relative to real time; 0 = unpaced. Empty = 1 for recordings and with
    /// `joystick`, 0 for simulated scenes.
    std::optional<double> speed;
    int port = 9090;  ///< TCP port of the gate; 0 = any free port
    std::string bind_address = "127.0.0.1";
    std::string token_file;  ///< access tokens of the roles; empty = ~/.local/state/surefoot/tokens
    std::string guests;      ///< role of a client without a token; empty = default of the gate
    std::string certificate_file;  ///< PEM certificate chain for TLS
    std::string key_file;
    std::string insecure;              ///< confirmation sentence that allows a network without TLS
    std::vector<std::string> origins;  ///< origins of web pages that may connect to the gate
    std::string audit_dir;
    bool assured = false;  ///< the gate never answers OK while it cannot write the audit log
    int max_rate_hz = 0;   ///< largest message rate of one client; 0 = default of the gate
    int audit_mb = 0;      ///< largest size of the audit folder [MB]; 0 = default of the gate
    /// Radius of the operator attestation at the start; 0 = no attestation.
    double attestation_radius_m = 0.0;
    std::string walk;       ///< joystick codes for a simulated REX; empty = no scripted walk
    bool joystick = false;  ///< a web page steers a simulated REX
    std::string out_dir;    ///< folder for a picture of each requested movement
    std::string channel;    ///< map channel in shared memory; empty = a new file
    /// File with the key of the map channel; empty = a new key at every start.
    std::string channel_key;
    int niceness = 10;     ///< process niceness of perception, so that the gate answers in time
    int page_port = 8080;  ///< TCP port of the live page; 0 = any free port
    /// Web origins of Foxglove that may read but not steer.
    std::vector<std::string> foxglove_origins;
    bool no_page = false;
    /// Pages may start recordings in new folders below it; empty = not allowed.
    std::string record_dir;
    bool once = false;  ///< exit when the source or the walk ends
};

constexpr double kRemembered_s = 10.0;  ///< of a simulated walk; no frame shows an older motion
constexpr auto kLookEvery = std::chrono::milliseconds(20);

/// Owns the writer of the snapshot channel and removes the channel file at the end of the program.
class Channel {
  public:
    explicit Channel(gate_process::SnapshotWriter its_writer) : writer(std::move(its_writer)) {}
    ~Channel() { writer.remove(); }
    Channel(const Channel&) = delete;
    Channel& operator=(const Channel&) = delete;

    /// Repairs the channel file if necessary, a few times a second, and logs the damage.
    void look_after(std::int64_t now_ns) {
        if (now_ns < next_ns_) return;
        next_ns_ = now_ns + kMendEvery_ns;
        const auto mended = writer.mend();
        if (mended && *mended)
            log_warning(
                fmt::format("the snapshot channel was damaged and is repaired: {}", **mended));
        if (!mended && mended.error().message != told_) log_error(mended.error().message);
        told_ = mended ? "" : mended.error().message;
    }

    gate_process::SnapshotWriter writer;

  private:
    static constexpr std::int64_t kMendEvery_ns = 250'000'000;
    std::int64_t next_ns_ = 0;
    std::string told_;  ///< last logged error, to log it only once
};

/// Sets the niceness of all threads except the first one. The answers of the gate have the highest
/// priority, then the first thread, which restarts the gate with its own priority. Linux stores the
/// priority per thread, so this function sets it for every existing thread; threads that those
/// start inherit it. The error contains the errno text of one of the failed threads. A thread that
/// has already ended is not an error.
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
        fmt::format("service.niceness: the system refuses {}: {}; restart serve with --nice {}",
                    niceness,
                    std::strerror(refusal),
                    niceness));
}

constexpr const char* kSharedMemory = "/dev/shm";
constexpr std::string_view kChannelEnd = ".channel";

std::string channel_begin() {
    return fmt::format("surefoot-{}-", ::getuid());
}

/// Removes channel files that killed services of this user left behind: the process id in the name
/// no longer exists.
void remove_orphaned_channels() {
    const std::string begin = channel_begin();
    std::error_code error;
    for (const auto& file : std::filesystem::directory_iterator(kSharedMemory, error)) {
        const std::string name = file.path().filename().string();
        if (!name.starts_with(begin) || !name.ends_with(kChannelEnd)) continue;
        const std::string_view process = std::string_view(name).substr(
            begin.size(), name.size() - begin.size() - kChannelEnd.size());
        ::pid_t number = 0;
        const auto [end, wrong] =
            std::from_chars(process.data(), process.data() + process.size(), number);
        if (wrong != std::errc{} || end != process.data() + process.size() || number <= 0) continue;
        if (::kill(number, 0) != 0 && errno == ESRCH) ::unlink(file.path().c_str());
    }
}

std::string channel_path(const ServeOptions& options) {
    if (!options.channel.empty()) return options.channel;
    remove_orphaned_channels();
    return fmt::format("{}/{}{}{}", kSharedMemory, channel_begin(), ::getpid(), kChannelEnd);
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
    SourceRequest request{options.source,
                          options.rig_file,
                          options.rate_hz,
                          options.max_frames,
                          options.common.seed,
                          settings.sim,
                          settings.live,
                          {},
                          first_frame,
                          options.reading};
    request.sim.commanded = options.joystick || !options.walk.empty();
    return open_source(request, executor);
}

/// The live page on its own thread. Does nothing if the user disabled the page.
class PageService {
  public:
    static Result<std::unique_ptr<PageService>> start(const ServeOptions& options,
                                                      const gate_process::Access& access) {
        std::unique_ptr<PageService> service(new PageService());
        if (options.no_page) return service;
        page::PageServerConfig config;
        config.bind_address = options.bind_address;
        config.port = static_cast<std::uint16_t>(options.page_port);
        config.foxglove_origins = options.foxglove_origins;
        config.origins = options.origins;
        config.tls = {options.certificate_file, options.key_file};
        config.insecure = options.insecure;
        // The socket of the page accepts a single token; only the gate distinguishes roles.
        if (access.guest == gate_process::Role::none) config.token = access.operator_;
        auto server = page::PageServer::open(config, service->feed_, service->controls_);
        if (!server) return server.error();
        service->server_ = std::move(server).value();
        if (options.page_port != 0 && service->server_->port() != options.page_port)
            log_warning(fmt::format("port {} is in use; the page uses the next free one",
                                    options.page_port));
        return service;
    }
    PageService(const PageService&) = delete;
    PageService& operator=(const PageService&) = delete;
    ~PageService() {
        if (!thread_.joinable()) return;
        server_->stop();
        thread_.join();
    }

    /// Sends this introduction to all present and later viewers. Call again when the port of the
    /// gate changes.
    void introduce(const page::PageHello& hello, const std::optional<io::MachineFile>& machine) {
        if (!server_) return;
        server_->introduce(hello,
                           machine ? page::colour_limits(machine->machine) : page::ColourLimits{});
        if (!thread_.joinable()) thread_ = std::thread([this] { server_->run(); });
    }
    [[nodiscard]] page::PageFeed* feed() noexcept { return server_ ? &feed_ : nullptr; }
    [[nodiscard]] page::PageControls& controls() noexcept { return controls_; }
    [[nodiscard]] std::uint16_t port() const noexcept { return server_ ? server_->port() : 0; }

  private:
    PageService() = default;

    page::PageFeed feed_;
    page::PageControls controls_;
    std::unique_ptr<page::PageServer> server_;
    std::thread thread_;
};

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

/// Runs perception on its own thread, beside the gate process and an optional steered walk. The
/// first thread supervises the gate independently of perception, so that a hanging frame cannot
/// delay the restart of the gate.
class Service {
  public:
    Service(const ServeOptions& options,
            Settings settings,
            const std::optional<io::MachineFile>& machine,
            const std::optional<io::MachineModel>& model,
            Executor& executor)
        : options_(options),
          settings_(std::move(settings)),
          machine_(machine),
          model_(model),
          executor_(executor) {}

    Status run();
    [[nodiscard]] const std::vector<AskedStep>& steps() const noexcept { return steps_; }

  private:
    Status perceive(std::unique_ptr<camera::FrameSource> source,
                    gate_process::SnapshotWriter& writer);
    Result<LiveSession::End> perceive_anew(camera::FrameSource& source,
                                           gate_process::SnapshotWriter& writer);
    Status perceive_beside(GateChild& gate,
                           std::unique_ptr<camera::FrameSource> source,
                           Channel& channel);
    Status introduce(const camera::FrameSource& source,
                     const gate_process::Access& access,
                     std::uint16_t gate_port);
    void offer_settings(bool is_scene);
    void offer_recording(const camera::FrameSource& source);
    Status apply(const ServiceConfig& wanted);
    Result<std::string> change(const page::SettingWish& wish);
    Status steer(camera::FrameSource& source,
                 const std::string& rider_token,
                 std::uint16_t gate_port);
    void follow_walk(sim::SceneSource& scene, const LiveSession& session);
    bool follow_pages(LiveSession& session, const gate_process::SnapshotWriter& writer);
    std::optional<int> next_jump(LiveSession::End end);
    void tell_where(const GateChild& gate);
    void look_after(GateChild& gate, Channel& channel);
    void remember_word(const LiveSession& session);
    void draw(const AskedStep& step, const grid::MapSnapshot& map);

    const ServeOptions& options_;
    Settings settings_;  ///< adapted to the rig of the source
    const std::optional<io::MachineFile>& machine_;
    const std::optional<io::MachineModel>& model_;
    Executor& executor_;
    /// Destroyed after `page_`, because pages change it.
    std::optional<ServiceSettings> service_settings_;
    std::atomic<int> niceness_{0};
    std::atomic<double> scene_speed_{0.0};
    std::unique_ptr<PageService> page_;
    std::optional<FrameRecorder> recorder_;  ///< destroyed before `page_`, which it notifies
    page::PageHello hello_;
    double speed_ = 1.0;  ///< playback speed relative to real time; 0 = unpaced
    std::unique_ptr<SteeredWalk> walk_;
    std::vector<AskedStep> steps_;
    gate::Attestation word_;
    bool word_given_ = false;
};

/// With --json stdout is reserved for the answer, so the address goes to stderr.
void Service::tell_where(const GateChild& gate) {
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

void Service::look_after(GateChild& gate, Channel& channel) {
    channel.look_after(steady_now_ns());
    const auto started = gate.watch(steady_now_ns());
    if (!started) log_error(started.error().message);
    if (!started || !*started) return;
    log_warning(
        fmt::format("the gate process ended and was restarted ({} restarts so far); no movement is "
                    "allowed until it is ready",
                    gate.restarts()));
    tell_where(gate);
}

/// Applies the operator attestation to the pictures as the gate does: from the first map on.
void Service::remember_word(const LiveSession& session) {
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

void Service::draw(const AskedStep& step, const grid::MapSnapshot& map) {
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

void Service::follow_walk(sim::SceneSource& scene, const LiveSession& session) {
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

/// Waits while a page has paused the recording. Returns false if a page wants to jump to another
/// frame.
bool Service::follow_pages(LiveSession& session, const gate_process::SnapshotWriter& writer) {
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

/// Processes the source with a new pipeline (one map, one odom frame), from its next frame on.
Result<LiveSession::End> Service::perceive_anew(camera::FrameSource& source,
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

/// The frame to continue from. At the end of a recording waits for a jump of a page.
std::optional<int> Service::next_jump(LiveSession::End end) {
    page::Playback& playback = page_->controls().playback;
    if (end == LiveSession::End::source_ended && playback.state() && !options_.once) {
        while (!playback.jump_wanted() && !interrupted()) std::this_thread::sleep_for(kLookEvery);
    }
    return playback.take_jump();
}

Status Service::perceive(std::unique_ptr<camera::FrameSource> source,
                         gate_process::SnapshotWriter& writer) {
    while (true) {
        const auto end = perceive_anew(*source, writer);
        if (!end) return end.error();
        if (*end == LiveSession::End::restart_wanted) {
            log_warning("the gate was re-armed: the map and the odom frame start again");
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

Status Service::perceive_beside(GateChild& gate,
                                std::unique_ptr<camera::FrameSource> source,
                                Channel& channel) {
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
Status Service::introduce(const camera::FrameSource& source,
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

/// Pages see every setting of the run and can change the settings of the service.
void Service::offer_settings(bool is_scene) {
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

void Service::offer_recording(const camera::FrameSource& source) {
    FrameRecorderConfig config;
    config.record_dir = options_.record_dir;
    recorder_.emplace(config, source.rig(), source.info(), page_->controls().recording);
}

Status Service::apply(const ServiceConfig& wanted) {
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

Result<std::string> Service::change(const page::SettingWish& wish) {
    auto changed = service_settings_->change(wish);
    if (changed) {
        log_info(fmt::format("{} is now {} (a page asked for it)", wish.key, *changed));
    } else {
        log_warning(fmt::format("{} (a page asked for it)", changed.error().message));
    }
    return changed;
}

/// Starts the steered walk if --walk or --joystick asks for it.
Status Service::steer(camera::FrameSource& source,
                      const std::string& rider_token,
                      std::uint16_t gate_port) {
    if (options_.walk.empty() && !options_.joystick) return {};
    if (!options_.walk.empty() && options_.joystick)
        return usage_error("give either --walk or --joystick, not both");
    if (options_.joystick && options_.no_page)
        return usage_error("--joystick needs the page; remove --no-page");
    auto* const scene = dynamic_cast<sim::SceneSource*>(&source);
    if (scene == nullptr || !scene->commanded())
        return usage_error(
            "--walk and --joystick steer a simulated scene (sim:SCENE) only; no other source can "
            "be steered");
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

Status Service::run() {
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
    const std::string path = channel_path(options_);
    auto writer = gate_process::SnapshotWriter::create({path, *key});
    if (!writer) return writer.error();
    Channel channel(std::move(*writer));
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
    while (!options_.once && !interrupted()) {  // the gate keeps answering that the frames are old
        look_after(*gate, channel);
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    return {};
}

/// Loads the model that pages show. Without a model, pages show only the space that the machine
/// occupies.
Result<std::optional<io::MachineModel>> load_model(const ServeOptions& options,
                                                   const std::optional<io::MachineFile>& machine) {
    if (options.model.empty())
        return machine ? built_in_model(machine->name) : std::optional<io::MachineModel>{};
    auto model = find_model(options.model);
    if (!model) return model.error();
    return std::optional<io::MachineModel>(std::move(model).value());
}

/// `surefoot serve`: runs perception on a source and starts the gate process beside it.
int serve(const ServeOptions& options) {
    auto settings = load_settings(options.common);
    if (!settings) return report(settings.error());
    const auto machine = load_machine(options.machine);
    if (!machine) return report(machine.error());
    const auto model = load_model(options, *machine);
    if (!model) return report(model.error());
    if (options.no_page && !options.record_dir.empty()) {
        return report(
            usage_error("--record-dir needs the page, which starts a recording; remove --no-page"));
    }
    if (!options.out_dir.empty()) {
        if (auto made = io::make_folder(options.out_dir); !made) return report(made.error());
    }
    const auto executor = make_executor(options.common);
    Service service(options, std::move(*settings), *machine, *model, *executor);
    const Status served = service.run();
    if (options.common.json) print_answer(serve_json(service.steps()));
    return served ? kExitOk : report(served.error());
}

}  // namespace

void add_serve(VerbGroup verbs) {
    auto [verb, o] = verbs.add<ServeOptions>(
        "serve",
        "run the whole chain live, with the gate process beside it, which answers over a WebSocket "
        "(docs/reference/rosbridge.md)",
        "surefoot serve sim:walk_floor --attest 1 --walk 9,9 --port 0 --once "
        "--set sim.sensor=analytic",
        serve);
    verb.option("source", o.source, "the source; see 'surefoot run --help'").required();
    verb.option("--rig",
                o.rig_file,
                "calibration file, or name of a built-in rig, if the source has none")
        .value("FILE");
    verb.option("--machine", o.machine, "machine file, or name of a built-in machine")
        .show_default();
    verb.option("--model",
                o.model,
                "model of the machine for the page: a model file or a built-in name (default: the "
                "built-in model with the name of the machine)")
        .value("FILE|NAME");
    add_reading(verb, o.reading);
    add_skip_broken(verb, o.reading);
    verb.option("--rate", o.rate_hz, "frame rate of a source without time stamps, in Hz")
        .value("HZ");
    verb.option("--max-frames", o.max_frames, "stop after this number of frames").value("N");
    verb.option("--speed",
                o.speed,
                "playback speed as a factor of real time; 0 = as fast as possible (default: 1 for "
                "recordings and with --joystick, 0 for simulated scenes)")
        .not_negative()
        .value("X");
    verb.option("--port", o.port, "TCP port of the gate; 0 = any free port")
        .in(0, 65535)
        .show_default();
    verb.option("--bind",
                o.bind_address,
                "network address of the gate and the page; beyond loopback every client needs a "
                "token, and the service needs --certificate and --key")
        .show_default();
    verb.option("--token-file",
                o.token_file,
                "file with the tokens of observer, rider and operator; the first start creates it "
                "(default ~/.local/state/surefoot/tokens)")
        .value("FILE");
    verb.option("--guests",
                o.guests,
                "role of a client without a token: none, observer or rider (default: rider on "
                "loopback, none beyond)")
        .one_of({"none", "observer", "rider"})
        .value("ROLE");
    verb.option("--certificate", o.certificate_file, "TLS: certificate chain (PEM)").value("FILE");
    verb.option("--key", o.key_file, "TLS: private key (PEM), file mode 0600").value("FILE");
    verb.option("--insecure",
                o.insecure,
                "allow networks beyond loopback without TLS; TEXT is a confirmation sentence that "
                "the error message quotes")
        .value("TEXT");
    verb.option("--origin",
                o.origins,
                "web pages of this origin may ask the gate, for example http://192.0.2.7:8000, "
                "null or file://; the page is served under this origin too")
        .value("URL");
    verb.option("--audit", o.audit_dir, "folder for the audit log of the gate").value("DIR");
    verb.flag(
        "--assured", o.assured, "the gate never answers OK while it cannot write the audit log");
    verb.option(
            "--audit-mb",
            o.audit_mb,
            "largest size of the audit folder, in MB; beyond it the gate deletes the oldest logs")
        .positive()
        .value("MB");
    verb.option("--max-rate",
                o.max_rate_hz,
                "largest number of messages per second of one client of the gate")
        .positive()
        .value("HZ");
    verb.option("--attest",
                o.attestation_radius_m,
                "operator attestation: radius around the machine within which ground that was not "
                "measured counts as level. At most vouch_radius_m of the machine file (1.0 m for "
                "rex). The attestation ends when the machine leaves the circle")
        .not_negative()
        .value("M");
    verb.option("--walk",
                o.walk,
                "steer a simulated REX with joystick codes such as 9,9,17,25*6; a REX link asks "
                "the gate about each code")
        .value("CODES");
    verb.flag("--joystick",
              o.joystick,
              "steer a simulated REX from the page; a REX link asks the gate about each movement");
    verb.option("--out", o.out_dir, "folder for a picture of each requested movement").value("DIR");
    verb.option("--channel",
                o.channel,
                "file in shared memory that passes the maps to the gate (default: a new file)")
        .value("FILE");
    verb.option(
            "--channel-key",
            o.channel_key,
            "file with the key of the map channel, for a surefoot-gate that you start yourself: 32 "
            "hexadecimal digits, file mode 600 (default: a new key at every start)")
        .value("FILE");
    verb.option("--nice",
                o.niceness,
                "niceness of perception (see setpriority), so that the gate answers in time")
        .in(0, 19)
        .show_default()
        .value("N");
    verb.option("--page-port",
                o.page_port,
                "TCP port of the live page; if it is in use, the next free one; 0 = any free port")
        .in(0, 65535)
        .show_default();
    verb.option("--foxglove-origin",
                o.foxglove_origins,
                "origin from which Foxglove may read, for example https://app.foxglove.dev or "
                "file://; steering is not allowed from there")
        .value("URL");
    verb.flag("--no-page", o.no_page, "run the gate only, without the page for browsers");
    verb.option("--record-dir",
                o.record_dir,
                "allow pages to record the source; each recording is a new folder in DIR")
        .value("DIR");
    verb.flag(
        "--once", o.once, "stop at the end of the source or of the walk; pages cannot go back");
}

}  // namespace surefoot::app
