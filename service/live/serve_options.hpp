// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "service/console/options.hpp"

namespace surefoot::app {

/// Options of `surefoot serve`.
struct ServeOptions : SourceOptions {
    CommonOptions common;
    std::string machine = "rex";
    /// File or built-in name; empty = the built-in model with the name of the machine.
    std::string model;
    /// Playback speed relative to real time; 0 = unpaced. Empty = 1 for recordings and with
    /// `joystick`, 0 for simulated scenes.
    std::optional<double> speed;
    int port = 9090;  ///< TCP port of the gate; 0 = any free port
    std::string bind_address = "127.0.0.1";
    std::string token_file;  ///< file of access tokens; empty = ~/.local/state/surefoot/tokens
    std::string guests;      ///< role of a client without a token; empty = default of the gate
    std::string certificate_file;  ///< file of the certificate chain for TLS (PEM)
    std::string key_file;
    std::string insecure;              ///< confirmation sentence that allows a network without TLS
    std::vector<std::string> origins;  ///< origins of web pages that may connect to the gate
    std::string audit_dir;
    bool assured = false;  ///< true = never OK while the audit log cannot be written
    int max_rate_hz = 0;   ///< largest message rate of one client; 0 = default of the gate
    int audit_mb = 0;      ///< largest size of the audit folder [MB]; 0 = default of the gate
    /// Radius of the operator attestation at the start; 0 = no attestation.
    double attestation_radius_m = 0.0;
    std::string walk;       ///< joystick codes for a simulated REX; empty = no scripted walk
    bool joystick = false;  ///< true = a web page steers a simulated REX
    std::string out_dir;    ///< folder for a picture of each requested movement
    std::string channel;    ///< file of the map channel; empty = a new file
    /// File with the key of the map channel; empty = a new key at every start.
    std::string channel_key;
    int niceness = 10;     ///< niceness of perception; the gate gets more processor time
    int page_port = 8080;  ///< TCP port of the live page; 0 = any free port
    /// Web origins of Foxglove that may read but not steer.
    std::vector<std::string> foxglove_origins;
    bool no_page = false;
    /// Parent folder of recordings that pages start; empty = pages cannot record.
    std::string record_dir;
    bool once = false;  ///< stop when the source or the walk ends
};

}  // namespace surefoot::app
