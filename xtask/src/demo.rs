//! Runs the demo, after a look at what it loads at run time: a Vulkan driver and, on X11, the window libraries.

use std::{
    env,
    ffi::{OsStr, OsString},
    fs, io,
    io::IsTerminal,
    path::{Path, PathBuf},
    process::{Command, ExitCode},
};

/// A shared library that is loaded at run time, and the Debian package that holds it.
struct Library {
    file: &'static str,
    package: &'static str,
}

const VULKAN_LOADER: Library = Library {
    file: "libvulkan.so.1",
    package: "libvulkan1",
};

const VULKAN_DRIVER_PACKAGE: &str = "mesa-vulkan-drivers";

const X11: &[Library] = &[
    Library {
        file: "libX11.so.6",
        package: "libx11-6",
    },
    Library {
        file: "libX11-xcb.so.1",
        package: "libx11-xcb1",
    },
    Library {
        file: "libXcursor.so.1",
        package: "libxcursor1",
    },
    Library {
        file: "libXi.so.6",
        package: "libxi6",
    },
    Library {
        file: "libXrandr.so.2",
        package: "libxrandr2",
    },
    Library {
        file: "libxkbcommon.so.0",
        package: "libxkbcommon0",
    },
    Library {
        file: "libxkbcommon-x11.so.0",
        package: "libxkbcommon-x11-0",
    },
];

/// Builds and runs the demo in `workspace` and returns its exit code.
///
/// # Errors
///
/// When cargo cannot be started. What is missing and cannot be installed is only printed: the look at the system may
/// be wrong, and the demo says best itself what it lacks.
pub fn run(workspace: &Path, arguments: &[OsString]) -> io::Result<ExitCode> {
    if cfg!(target_os = "linux") {
        install(&missing_packages());
    }
    let cargo = env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let status = Command::new(cargo)
        .args(["run", "--ignore-rust-version", "--example", "demo", "--"])
        .args(arguments)
        .current_dir(workspace)
        .status()?;
    let code = status.code().and_then(|code| u8::try_from(code).ok());
    Ok(code.map_or(ExitCode::FAILURE, ExitCode::from))
}

fn missing_packages() -> Vec<&'static str> {
    let known = loader_cache();
    let mut wanted = vec![&VULKAN_LOADER];
    if env::var_os("DISPLAY").is_some() {
        wanted.extend(X11);
    }
    let mut missing: Vec<_> = wanted
        .into_iter()
        .filter(|library| !is_present(library, &known))
        .map(|library| library.package)
        .collect();
    if !has_vulkan_driver() {
        missing.push(VULKAN_DRIVER_PACKAGE);
    }
    missing
}

/// Output of `ldconfig -p`, or nothing where there is no ldconfig.
fn loader_cache() -> String {
    ["ldconfig", "/sbin/ldconfig"]
        .iter()
        .find_map(|ldconfig| Command::new(ldconfig).arg("-p").output().ok())
        .map(|output| String::from_utf8_lossy(&output.stdout).into_owned())
        .unwrap_or_default()
}

fn is_present(library: &Library, loader_cache: &str) -> bool {
    let cached = loader_cache
        .lines()
        .filter_map(|line| line.split_whitespace().next())
        .any(|name| name == library.file);
    let architecture = env::consts::ARCH;
    let folders = [
        "/usr/local/lib".into(),
        "/usr/lib".into(),
        "/usr/lib64".into(),
        format!("/usr/lib/{architecture}-linux-gnu"),
        "/lib".into(),
        "/lib64".into(),
        format!("/lib/{architecture}-linux-gnu"),
    ];
    cached
        || paths("LD_LIBRARY_PATH", "")
            .into_iter()
            .chain(folders.iter().map(PathBuf::from))
            .any(|folder| folder.join(library.file).exists())
}

/// Returns whether the Vulkan loader would find the manifest of a driver, in the places where it looks.
fn has_vulkan_driver() -> bool {
    for variable in ["VK_DRIVER_FILES", "VK_ICD_FILENAMES"] {
        if env::var_os(variable).is_some() {
            return paths(variable, "")
                .iter()
                .any(|path| path.is_file() || has_manifest(path));
        }
    }
    let mut roots = paths("XDG_DATA_DIRS", "/usr/local/share:/usr/share");
    roots.extend(paths("XDG_CONFIG_DIRS", "/etc/xdg"));
    roots.extend(paths("XDG_DATA_HOME", ""));
    roots.extend(env::home_dir().map(|home| home.join(".local/share")));
    roots.extend(["/etc", "/usr/local/share", "/usr/share"].map(PathBuf::from));
    roots
        .iter()
        .any(|root| has_manifest(&root.join("vulkan/icd.d")))
}

fn has_manifest(folder: &Path) -> bool {
    let Ok(entries) = fs::read_dir(folder) else {
        return false;
    };
    entries
        .flatten()
        .any(|entry| entry.path().extension() == Some(OsStr::new("json")))
}

/// The paths in an environment variable, or in `default` where it is unset or empty.
fn paths(variable: &str, default: &str) -> Vec<PathBuf> {
    let value = env::var_os(variable)
        .filter(|value| !value.is_empty())
        .unwrap_or_else(|| default.into());
    env::split_paths(&value)
        .filter(|path| !path.as_os_str().is_empty())
        .collect()
}

fn install(packages: &[&str]) {
    if packages.is_empty() {
        return;
    }
    let list = packages.join(" ");
    if !Path::new("/usr/bin/apt-get").exists() {
        println!("The demo may not start: please install what Debian calls {list}.");
        return;
    }
    println!("Installing {list} with apt-get.");
    let installed =
        apt_get(&["update", "-q"]) && apt_get(&[&["install", "-y", "-q"], packages].concat());
    if !installed {
        println!("That failed: please install {list} by hand. Going on without.");
    }
}

/// Runs apt-get as root, through sudo where this is another user. Sudo may ask for a password only at a terminal.
fn apt_get(arguments: &[&str]) -> bool {
    let mut command: Vec<&str> = Vec::new();
    if !is_root() {
        command.push("sudo");
        if !io::stdin().is_terminal() {
            command.push("-n");
        }
    }
    command.extend(["env", "DEBIAN_FRONTEND=noninteractive", "apt-get"]);
    command.extend(arguments);
    println!("> {}", command.join(" "));
    Command::new(command[0])
        .args(&command[1..])
        .status()
        .is_ok_and(|status| status.success())
}

fn is_root() -> bool {
    Command::new("id")
        .arg("-u")
        .output()
        .is_ok_and(|output| output.stdout.trim_ascii() == b"0")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_library_in_the_loader_cache_is_present() {
        let library = Library {
            file: "libnowhere.so.1",
            package: "libnowhere1",
        };
        assert!(is_present(
            &library,
            "\tlibnowhere.so.1 (libc6,x86-64) => /opt/libnowhere.so.1\n"
        ));
        assert!(!is_present(
            &library,
            "\tlibnowhere.so.12 (libc6,x86-64) => /opt/libnowhere.so.12\n"
        ));
    }

    #[test]
    fn a_path_variable_falls_back_to_its_default() {
        assert_eq!(
            paths("TAILORBIRD_UNSET", "/a:/b"),
            [PathBuf::from("/a"), PathBuf::from("/b")]
        );
        assert!(paths("TAILORBIRD_UNSET", "").is_empty());
    }
}
