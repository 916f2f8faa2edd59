//! Tells the crate how it is optimised: `cfg(debug_assertions)` says nothing of it.

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rustc-check-cfg=cfg(unoptimised)");
    let level = std::env::var("OPT_LEVEL");
    if level.is_ok_and(|level| level == "0") {
        println!("cargo::rustc-cfg=unoptimised");
    }
}
