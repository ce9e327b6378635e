//! Files, logs and a shell.

use super::station::Station;
use mavlink::dialects::common as mav;
use tautline_firmware::mavlink::crc32;
use tautline_firmware::param::{ALIASES, META};
use tautline_sitl::flight::Flight;
use tautline_sitl::ground::Files;
use tautline_tests::flight;

fn ftp(opcode: u8, offset: u32, size: u8, name: &str) -> mav::FILE_TRANSFER_PROTOCOL_DATA {
    let mut payload = [0; 251];
    payload[3] = opcode;
    payload[4] = if name.is_empty() { size } else { name.len() as u8 };
    payload[8..12].copy_from_slice(&offset.to_le_bytes());
    payload[12..12 + name.len()].copy_from_slice(name.as_bytes());
    mav::FILE_TRANSFER_PROTOCOL_DATA {
        target_network: 0,
        target_system: 1,
        target_component: 1,
        payload,
    }
}

/// Opcode and data of each answer.
fn answers(
    station: &mut Station,
    flight: &mut Flight<Vec<u8>>,
    ask: &mav::FILE_TRANSFER_PROTOCOL_DATA,
) -> Vec<(u8, Vec<u8>)> {
    station.heard.clear();
    station.say(flight, ask);
    station.run(flight, 100);
    let all = station.all::<mav::FILE_TRANSFER_PROTOCOL_DATA>();
    all.iter()
        .map(|m| (m.payload[3], m.payload[12..][..usize::from(m.payload[4])].to_vec()))
        .collect()
}

/// A whole file, read in bursts.
fn read(station: &mut Station, flight: &mut Flight<Vec<u8>>, name: &str) -> Vec<u8> {
    let open = answers(station, flight, &ftp(4, 0, 0, name));
    assert_eq!(open[0].0, 128, "{name}");
    let size = u32::from_le_bytes(open[0].1[..4].try_into().unwrap()) as usize;
    let mut bytes = Vec::new();
    while bytes.len() < size {
        let got = answers(station, flight, &ftp(15, bytes.len() as u32, 239, ""));
        for (code, data) in got.iter().filter(|(code, _)| *code == 128) {
            assert_eq!(*code, 128);
            bytes.extend(data);
        }
    }
    bytes
}

fn begin() -> (Flight<Vec<u8>>, Station) {
    let mut flight = flight("", 1);
    let mut station = Station::new(255, 1);
    station.beat(&mut flight);
    station.run(&mut flight, 20);
    (flight, station)
}

#[test]
fn what_the_parameters_mean_is_a_file_with_the_checksums_that_were_told() {
    let (mut flight, mut station) = begin();
    station.command(&mut flight, 512, [397.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    let told = station.all::<mav::COMPONENT_METADATA_DATA>();
    let uri = told[0].uri.to_str().unwrap().to_owned();
    let general = read(&mut station, &mut flight, uri.strip_prefix("mftp://").unwrap());
    assert_eq!(crc32(0, &general), told[0].file_crc);
    let general: serde_json::Value = serde_json::from_slice(&general).unwrap();
    let about = &general["metadataTypes"][0];
    let uri = about["uri"].as_str().unwrap();
    let text = read(&mut station, &mut flight, uri.strip_prefix("mftp://").unwrap());
    assert_eq!(u64::from(crc32(0, &text)), about["fileCrc"].as_u64().unwrap());
    let parameters: serde_json::Value = serde_json::from_slice(&text).unwrap();
    let all = parameters["parameters"].as_array().unwrap();
    assert_eq!(all.len(), META.len() + ALIASES.len());
    assert_eq!(all[0]["name"], "VEH_MASS");
    assert_eq!(all[0]["units"], "kg");
    assert_eq!(all[0]["default"], 1.5);
}

#[test]
fn packed_parameters_hold_every_name_and_value() {
    let (mut flight, mut station) = begin();
    let bytes = read(&mut station, &mut flight, "@PARAM/param.pck");
    assert_eq!(bytes[..2], [0x1B, 0x67]);
    let (mut at, mut last, mut found) = (6, String::new(), Vec::new());
    while at < bytes.len() {
        let (kind, alike, rest) =
            (bytes[at], usize::from(bytes[at + 1] & 15), usize::from(bytes[at + 1] >> 4) + 1);
        let name =
            last[..alike].to_owned() + std::str::from_utf8(&bytes[at + 2..][..rest]).unwrap();
        let value: [u8; 4] = bytes[at + 2 + rest..][..4].try_into().unwrap();
        let value =
            if kind == 3 { i32::from_le_bytes(value) as f32 } else { f32::from_le_bytes(value) };
        at += 6 + rest;
        found.push((name.clone(), value));
        last = name;
    }
    assert_eq!(found.len(), META.len() + ALIASES.len());
    assert!(found.contains(&("VEH_MASS".into(), 1.5)));
    assert!(found.contains(&("SYS_AUTOSTART".into(), 4001.0)));
}

#[test]
fn files_are_read_and_nothing_is_written() {
    let (mut flight, mut station) = begin();
    let mut refusal = |opcode: u8, name: &str| {
        let got = answers(&mut station, &mut flight, &ftp(opcode, 0, 10, name));
        assert_eq!((got.len(), got[0].0), (1, 129), "{opcode} {name}");
        got[0].1[0]
    };
    for opcode in 6..=13 {
        assert_eq!(refusal(opcode, "/log/x"), 9, "{opcode}");
    }
    assert_eq!(refusal(4, "/etc/passwd"), 10);
    assert_eq!(refusal(4, "/log/../../etc/passwd"), 10);
    assert_eq!(refusal(4, "/log/"), 10, "a folder is no file");
    assert_eq!(refusal(3, "/nowhere"), 10);
    assert_eq!(refusal(5, ""), 4, "nothing is open");
    assert_eq!(refusal(99, "x"), 7);
    let got = answers(&mut station, &mut flight, &ftp(3, 0, 0, "/etc/extras"));
    let text = String::from_utf8(got[0].1.clone()).unwrap();
    assert!(text.contains("Fcomponent_general.json\t") && text.contains("Fparameters.json\t"));
}

#[test]
fn logs_are_listed_and_downloaded_byte_for_byte() {
    let folder = std::env::temp_dir().join(format!("tautline-logs-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let bytes: Vec<u8> = (0..1000_u32).map(|i| (i * 7) as u8).collect();
    std::fs::write(folder.join("flight-0001.ulg"), &bytes).unwrap();
    std::fs::write(folder.join("notes.txt"), b"not a log").unwrap();
    let (mut flight, mut station) = begin();
    flight.world.links.files = Files::with_logs(&folder);
    let list = mav::LOG_REQUEST_LIST_DATA { end: u16::MAX, target_system: 1, ..Default::default() };
    station.say(&mut flight, &list);
    station.run(&mut flight, 20);
    let entries = station.all::<mav::LOG_ENTRY_DATA>();
    assert_eq!((entries.len(), entries[0].num_logs, entries[0].size), (1, 1, 1000));
    let ask = mav::LOG_REQUEST_DATA_DATA {
        ofs: 0,
        count: u32::MAX,
        id: entries[0].id,
        target_system: 1,
        target_component: 1,
    };
    station.say(&mut flight, &ask);
    station.run(&mut flight, 20);
    let mut got = vec![0; 1000];
    for piece in station.all::<mav::LOG_DATA_DATA>() {
        let count = usize::from(piece.count);
        got[piece.ofs as usize..][..count].copy_from_slice(&piece.data[..count]);
    }
    assert_eq!(got, bytes);
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn the_shell_answers_and_touches_nothing() {
    let (mut flight, mut station) = begin();
    let mut type_in = |line: &str| {
        let mut data = [0; 70];
        data[..line.len()].copy_from_slice(line.as_bytes());
        let message = mav::SERIAL_CONTROL_DATA {
            device: mav::SerialControlDev::SERIAL_CONTROL_DEV_SHELL,
            flags: mav::SerialControlFlag::SERIAL_CONTROL_FLAG_RESPOND,
            count: line.len() as u8,
            data,
            ..Default::default()
        };
        station.heard.clear();
        station.say(&mut flight, &message);
        station.run(&mut flight, 20);
        let pieces = station.all::<mav::SERIAL_CONTROL_DATA>();
        let bytes = pieces.iter().flat_map(|m| m.data[..usize::from(m.count)].to_vec());
        String::from_utf8(bytes.collect()).unwrap()
    };
    assert!(type_in("help\n").contains("status"));
    assert!(type_in("params VEH_MA\n").contains("VEH_MASS 1.5"));
    assert!(type_in("tether\n").contains("tether"));
    assert!(type_in("faults\n").contains("none"));
    assert!(type_in("status\n").contains("disarmed"));
    assert!(type_in("reboot\n").contains("unknown"));
}

/// Two clients behind one address, as behind a router.
#[test]
fn an_open_session_is_taken_from_nobody_who_uses_it() {
    let (mut flight, mut first) = begin();
    let mut second = Station::new(254, 1);
    let file = "/etc/extras/parameters.json";
    let open = ftp(4, 0, 0, file);
    assert_eq!(answers(&mut first, &mut flight, &open)[0].0, 128);
    let piece = answers(&mut first, &mut flight, &ftp(5, 0, 100, ""));
    let refused = vec![(129, vec![5])];
    assert_eq!(answers(&mut second, &mut flight, &open), refused, "no session is free");
    assert_eq!(answers(&mut second, &mut flight, &ftp(5, 0, 100, "")), [(129, vec![4])]);
    // To end the other's works as little as to read from it.
    for end in [1, 2] {
        assert_eq!(answers(&mut second, &mut flight, &ftp(end, 0, 0, ""))[0].0, 128);
    }
    assert_eq!(answers(&mut first, &mut flight, &ftp(5, 0, 100, "")), piece);
    assert_eq!(answers(&mut first, &mut flight, &open)[0].0, 128, "its own, once more");
    // Still in use 8 s later, and 8 s after that.
    for _ in 0..2 {
        first.run(&mut flight, 8000);
        assert_eq!(answers(&mut first, &mut flight, &ftp(5, 0, 100, "")), piece);
    }
    assert_eq!(answers(&mut second, &mut flight, &open), refused);
    first.run(&mut flight, 10_000);
    assert_eq!(answers(&mut second, &mut flight, &open)[0].0, 128, "nobody used it");
    assert_eq!(answers(&mut first, &mut flight, &ftp(5, 0, 100, "")), [(129, vec![4])]);
    answers(&mut second, &mut flight, &ftp(1, 0, 0, ""));
    assert_eq!(answers(&mut first, &mut flight, &open)[0].0, 128, "it was given back");
}
