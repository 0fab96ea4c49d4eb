//! Builds anew when the page gains or loses a file; changes of its files are seen without this.
fn main() {
    println!("cargo:rerun-if-changed=../web");
}
