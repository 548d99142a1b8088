// SPDX-License-Identifier: Apache-2.0
#include <optional>

#include "cli/json/service_answers.hpp"
#include "cli/verbs/verbs.hpp"
#include "service/console/log.hpp"
#include "service/console/option_settings.hpp"
#include "service/console/source.hpp"
#include "service/live/find_model.hpp"
#include "service/live/live_service.hpp"
#include "surefoot/io/file.hpp"

namespace surefoot::app {
namespace {

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
    LiveService service(options, std::move(*settings), *machine, *model, *executor);
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
    verb.option(
            "--attest",
            o.attestation_radius_m,
            "operator attestation: radius around the machine within which ground that was not "
            "measured counts as level. At most attestation_radius_m of the machine file (1.0 m for "
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
