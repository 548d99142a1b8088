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
            usage_error("--record-dir needs the live page, because the page starts recordings; "
                        "remove --no-page"));
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
        "run the whole chain live, together with the gate process and the live page; the gate "
        "answers over a WebSocket (docs/reference/rosbridge.md)",
        "surefoot serve sim:walk_floor --attest 1 --walk 9,9 --port 0 --once "
        "--set sim.sensor=analytic",
        serve);
    verb.option("source",
                o.source,
                "source of the frames: a live camera v4l2:DEVICE, sim:SCENE, a recording or a "
                "video; 'surefoot run --help' lists all kinds")
        .required();
    verb.option("--rig",
                o.rig_file,
                "calibration file; it replaces the calibration of the source. For a simulated "
                "scene also the name of a built-in rig, for example zed_vga")
        .value("FILE");
    verb.option(
            "--machine",
            o.machine,
            "machine that the gate judges for: a machine file, or the name of a built-in machine")
        .show_default();
    verb.option("--model",
                o.model,
                "3D model of the machine that the page draws: a model file, or the name of a "
                "built-in model (default: the built-in model with the name of the machine)")
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
    verb.option(
            "--bind",
            o.bind_address,
            "network address at which the gate and the page listen. At an address beyond loopback "
            "every client needs a token, and the service needs --certificate and --key")
        .show_default();
    verb.option("--token-file",
                o.token_file,
                "file with the tokens of observer, rider and operator; the first start creates it "
                "(default ~/.local/state/surefoot/tokens)")
        .value("FILE");
    verb.option("--guests",
                o.guests,
                "role of a client without a token: none, observer or rider (default: rider if "
                "--bind is a loopback address, otherwise none)")
        .one_of({"none", "observer", "rider"})
        .value("ROLE");
    verb.option("--certificate",
                o.certificate_file,
                "file with the certificate chain for TLS, in PEM format; needs --key")
        .value("FILE");
    verb.option("--key",
                o.key_file,
                "file with the private key for TLS, in PEM format; its file mode must be 0600; "
                "needs --certificate")
        .value("FILE");
    verb.option("--insecure",
                o.insecure,
                "allow an address beyond loopback without TLS; TEXT must be the confirmation "
                "sentence, which the error message quotes")
        .value("TEXT");
    verb.option("--origin",
                o.origins,
                "origin whose web pages may ask the gate and connect to the live page's socket, "
                "for example http://192.0.2.7:8000, null or file://. If the origin has a host "
                "name, the live page also answers requests to this host")
        .value("URL");
    verb.option("--audit", o.audit_dir, "folder for the audit log of the gate").value("DIR");
    verb.flag("--assured",
              o.assured,
              "let the gate never answer OK while it cannot write the audit log; needs --audit");
    verb.option("--audit-mb",
                o.audit_mb,
                "largest size of the folder of the audit log, in MB; if the folder grows larger, "
                "the gate deletes the oldest logs")
        .positive()
        .value("MB");
    verb.option("--max-rate",
                o.max_rate_hz,
                "largest number of messages from one client in a second; the gate refuses further "
                "messages, and answers further step questions with OVERLOAD")
        .positive()
        .value("HZ");
    verb.option("--attest",
                o.attestation_radius_m,
                "operator attestation: radius around the machine, in m, within which ground that "
                "was not measured counts as level. At most attestation_radius_m of the machine "
                "file (1.0 "
                "m for rex). The attestation ends when the machine leaves the circle")
        .not_negative()
        .value("M");
    verb.option("--walk",
                o.walk,
                "steer a simulated REX with these joystick codes, for example 9,9,17,25*6 (25*6 = "
                "code 25 six times). A REX link asks the gate about each code")
        .value("CODES");
    verb.flag("--joystick",
              o.joystick,
              "steer a simulated REX from the page; a REX link asks the gate about each movement");
    verb.option("--out",
                o.out_dir,
                "folder for a picture of each movement that --walk or --joystick requests")
        .value("DIR");
    verb.option(
            "--channel",
            o.channel,
            "file that passes the maps to the gate process (default: a new file in shared memory)")
        .value("FILE");
    verb.option("--channel-key",
                o.channel_key,
                "file with the key of the map channel: 32 hexadecimal digits, file mode 600. Give "
                "it if you start surefoot-gate yourself (default: a new key at every start)")
        .value("FILE");
    verb.option("--nice",
                o.niceness,
                "niceness of perception (as in setpriority); a larger value leaves more processor "
                "time to the gate")
        .in(0, 19)
        .show_default()
        .value("N");
    verb.option("--page-port",
                o.page_port,
                "TCP port of the live page; 0 = any free port. If the port is in use, the page "
                "takes the next free port")
        .in(0, 65535)
        .show_default();
    verb.option("--foxglove-origin",
                o.foxglove_origins,
                "origin of Foxglove that may read, for example https://app.foxglove.dev or "
                "file://; this origin cannot steer")
        .value("URL");
    verb.flag("--no-page",
              o.no_page,
              "do not serve the live page; perception and the gate run without it");
    verb.option("--record-dir",
                o.record_dir,
                "allow live pages to record the source; each recording is a new folder in DIR")
        .value("DIR");
    verb.flag("--once",
              o.once,
              "stop the service at the end of the source or of the walk; live pages then cannot go "
              "back to an earlier frame");
}

}  // namespace surefoot::app
